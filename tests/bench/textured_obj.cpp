// SPDX-License-Identifier: MIT
#include "tests/bench/textured_obj.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "ooc/memory_budget.h"
#include "streaming/image_rows.h"

namespace bench {

namespace {

Image read_image(const std::filesystem::path& path) {
    hewer::ooc::MemoryBudget budget(std::uint64_t{8} << 30);
    const auto file = std::make_shared<hewer::ooc::InputFile>(path);
    const auto rows = hewer::streaming::open_image({file, 0, file->size()}, budget);
    Image image{rows->width(), rows->height(), {}};
    image.rgb.resize(std::size_t{3} * image.width * image.height);
    for (std::size_t y = 0; y < image.height; ++y) {
        rows->read_row(image.rgb.data() + 3 * y * image.width);
    }
    return image;
}

/// Numbers of images by material; reads the images.
void read_materials(const std::filesystem::path& path, TexturedObj& mesh,
                    std::map<std::string, std::size_t>& image_of) {
    std::ifstream in(path);
    std::string line;
    std::string material;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "newmtl") {
            words >> material;
        } else if (word == "map_Kd") {
            words >> word;
            image_of[material] = mesh.images.size();
            mesh.images.push_back(read_image(path.parent_path() / word));
        }
    }
}

}  // namespace

Rgb Image::at(double u, double v) const {
    const double x = (u - std::floor(u)) * width - 0.5;
    const double y = (1 - (v - std::floor(v))) * height - 0.5;
    const double x0 = std::floor(x);
    const double y0 = std::floor(y);
    Rgb color{};
    for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
            const double share =
                (dx == 1 ? x - x0 : 1 - (x - x0)) * (dy == 1 ? y - y0 : 1 - (y - y0));
            const auto column = static_cast<std::size_t>(
                (static_cast<std::int64_t>(x0) + dx + width) % static_cast<std::int64_t>(width));
            const auto row = static_cast<std::size_t>(
                (static_cast<std::int64_t>(y0) + dy + height) % static_cast<std::int64_t>(height));
            for (std::size_t k = 0; k < 3; ++k) {
                color[k] += static_cast<float>(share * rgb[3 * (row * width + column) + k] / 255);
            }
        }
    }
    return color;
}

TexturedObj read_textured_obj(const std::string& path) {
    TexturedObj mesh;
    std::map<std::string, std::size_t> image_of;
    std::size_t image = 0;
    std::ifstream in(path);
    std::string line;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            auto& p = mesh.positions.emplace_back();
            words >> p[0] >> p[1] >> p[2];
        } else if (word == "vt") {
            auto& t = mesh.texcoords.emplace_back();
            words >> t[0] >> t[1];
        } else if (word == "f") {
            TexturedObj::Face face{{}, image};
            char slash = 0;
            for (TexturedObj::Corner& c : face.corners) {
                words >> c.vertex >> slash >> c.texcoord;
                --c.vertex;
                --c.texcoord;
            }
            if (!words) throw std::runtime_error(path + ": a face of another kind: " + line);
            mesh.faces.push_back(face);
        } else if (word == "usemtl") {
            words >> word;
            image = image_of.at(word);
        } else if (word == "mtllib") {
            words >> word;
            read_materials(std::filesystem::path(path).parent_path() / word, mesh, image_of);
        }
    }
    if (mesh.faces.empty()) throw std::runtime_error(path + ": no faces");
    return mesh;
}

}  // namespace bench
