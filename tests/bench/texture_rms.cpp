// SPDX-License-Identifier: MIT
/// How much pictures of simplified meshes with vertex colours differ from those of the textured
/// original.
///
///     texture_rms ORIGINAL.obj MESH.ply...      root mean square, as a JSON array
///     texture_rms --points ORIGINAL.obj OUT.ply vertex colours by one bilinear sample at each
///                                               vertex: what readers without a filter make
///     texture_rms --picture OUT.png ORIGINAL.obj MESH.ply...  all side by side
///
/// Twenty views of 512 x 512 pixels, from the vertices of a dodecahedron around the original. The
/// error is over red, green and blue (0..255) of the pixels that the original covers, light
/// included. The original is drawn with its texture: each triangle in so many pieces that none
/// spans more than a texel, with the texture at their corners.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "ooc/memory_budget.h"
#include "ooc/vec3.h"
#include "render/png.h"
#include "render/rasteriser.h"
#include "streaming/image_rows.h"
#include "tests/bench/textured_obj.h"
#include "tests/bench/views.h"

namespace {

using namespace hewer;
using bench::Sphere;
using bench::TexturedObj;
using raster::Rasteriser;

constexpr unsigned kSide = 512;
constexpr unsigned kMostPieces = 16;  // along an edge
constexpr std::uint64_t kBudget = std::uint64_t{1} << 30;

using Pixels = std::vector<std::uint8_t>;
using Draw = std::function<void(Rasteriser&)>;

Pixels picture(const Draw& draw, const Vec3& toward, const Sphere& sphere) {
    ooc::MemoryBudget budget(kBudget);
    Rasteriser rasteriser(budget, kSide, kSide, bench::camera_at(toward, sphere.radius, kSide), {});
    draw(rasteriser);
    Pixels pixels(std::size_t{3} * kSide * kSide);
    rasteriser.resolve(pixels);
    return pixels;
}

Sphere bounding_sphere(const TexturedObj& mesh) {
    Bounds bounds;
    for (const auto& p : mesh.positions) bounds.extend(Vec3{p[0], p[1], p[2]});
    return {bounds.center(), 0.5 * bounds.diagonal()};
}

Vec3 to_vec3(const std::array<float, 3>& p) {
    return {p[0], p[1], p[2]};
}

/// A triangle of the original, cut to pieces.
void draw_textured(const TexturedObj& mesh, const TexturedObj::Face& face, const Vec3& center,
                   Rasteriser& rasteriser) {
    const bench::Image& image = mesh.images[face.image];
    std::array<Vec3, 3> p;
    std::array<std::array<double, 2>, 3> t;
    for (std::size_t c = 0; c < 3; ++c) {
        p[c] = to_vec3(mesh.positions[face.corners[c].vertex]) - center;
        const auto& uv = mesh.texcoords[face.corners[c].texcoord];
        t[c] = {uv[0], uv[1]};
    }
    double longest = 1;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& a = t[c];
        const auto& b = t[(c + 1) % 3];
        longest = std::max(longest,
                           std::hypot((a[0] - b[0]) * image.width, (a[1] - b[1]) * image.height));
    }
    const auto n =
        static_cast<unsigned>(std::min(std::ceil(longest), static_cast<double>(kMostPieces)));
    struct Point {
        Vec3 position;
        bench::Rgb color;
    };
    const auto at = [&](unsigned i, unsigned j) {
        const double b0 = static_cast<double>(i) / n;
        const double b1 = static_cast<double>(j) / n;
        const double b2 = 1 - b0 - b1;
        return Point{b0 * p[0] + (b1 * p[1] + b2 * p[2]),
                     image.at(b0 * t[0][0] + b1 * t[1][0] + b2 * t[2][0],
                              b0 * t[0][1] + b1 * t[1][1] + b2 * t[2][1])};
    };
    const auto draw = [&](const Point& a, const Point& b, const Point& c) {
        const Rasteriser::Paint paint{a.color, b.color, c.color};
        rasteriser.draw({a.position, b.position, c.position}, &paint);
    };
    for (unsigned i = 0; i < n; ++i) {
        for (unsigned j = 0; i + j < n; ++j) {
            draw(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 1 < n) draw(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
}

Mesh read_colored(const char* path) {
    Mesh mesh;
    const auto source = open_mesh(path);
    VertexBatch vertices;
    source->begin_vertices();
    while (source->next_vertices(vertices)) {
        mesh.positions.insert(mesh.positions.end(), vertices.positions.begin(),
                              vertices.positions.end());
        mesh.colors.insert(mesh.colors.end(), vertices.colors.begin(), vertices.colors.end());
    }
    TriangleBatch triangles;
    source->begin_triangles();
    while (source->next_triangles(triangles)) {
        mesh.triangles.insert(mesh.triangles.end(), triangles.corners.begin(),
                              triangles.corners.end());
    }
    return mesh;
}

void draw_colored(const Mesh& mesh, const Vec3& center, Rasteriser& rasteriser) {
    for (const Triangle& triangle : mesh.triangles) {
        std::array<Vec3, 3> p;
        Rasteriser::Paint paint;
        for (std::size_t c = 0; c < 3; ++c) {
            p[c] = mesh.positions[triangle[c]] - center;
            for (std::size_t k = 0; k < 3; ++k) {
                paint[c][k] = static_cast<float>(mesh.colors[triangle[c]][k]) / 65535;
            }
        }
        rasteriser.draw(p, &paint);
    }
}

/// Over the pixels that the original covers: where it differs from the background.
struct Difference {
    double sum = 0;
    std::uint64_t n = 0;

    void add(const Pixels& original, const Pixels& other, const Pixels& background) {
        for (std::size_t i = 0; i < original.size(); i += 3) {
            if (std::equal(&original[i], &original[i] + 3, &background[i])) continue;
            for (std::size_t k = i; k < i + 3; ++k) {
                const double d = static_cast<double>(original[k]) - static_cast<double>(other[k]);
                sum += d * d;
                ++n;
            }
        }
    }
    [[nodiscard]] double rms() const { return std::sqrt(sum / static_cast<double>(n)); }
};

void compare(const Draw& original, const std::vector<Draw>& others, const Sphere& sphere) {
    std::vector<Difference> differences(others.size());
    for (const Vec3& toward : bench::dodecahedron()) {
        const Pixels background = picture([](Rasteriser&) {}, toward, sphere);
        const Pixels wanted = picture(original, toward, sphere);
        for (std::size_t i = 0; i < others.size(); ++i) {
            differences[i].add(wanted, picture(others[i], toward, sphere), background);
        }
    }
    nlohmann::json result = nlohmann::json::array();
    for (const Difference& d : differences) result.push_back(d.rms());
    std::puts(result.dump().c_str());
}

void draw_side_by_side(const char* path, const std::vector<Draw>& draws, const Sphere& sphere) {
    Pixels all(draws.size() * 3 * kSide * kSide);
    for (std::size_t i = 0; i < draws.size(); ++i) {
        const Vec3 from{0.2, 1, 0.35};
        const Pixels one = picture(draws[i], (1 / std::sqrt(dot(from, from))) * from, sphere);
        for (std::size_t y = 0; y < kSide; ++y) {
            std::memcpy(&all[(y * draws.size() + i) * 3 * kSide], &one[y * 3 * kSide], 3 * kSide);
        }
    }
    ooc::MemoryBudget budget(kBudget);
    ooc::OutputFile file(path, true);
    raster::write_png(file, all, kSide * static_cast<unsigned>(draws.size()), kSide, budget);
    file.commit();
}

void write_points(const TexturedObj& original, const char* path) {
    SinkHeader header;
    header.n_vertices = original.positions.size();
    header.n_triangles = original.faces.size();
    header.has_colors = true;
    std::vector<Vec3> positions;
    for (const auto& p : original.positions) {
        positions.push_back(to_vec3(p));
        header.bounds.extend(positions.back());
    }
    std::vector<Rgba16> colors(positions.size(), Rgba16{65535, 65535, 65535, 65535});
    std::vector<Triangle> triangles;
    for (const TexturedObj::Face& face : original.faces) {
        Triangle t;
        for (std::size_t c = 0; c < 3; ++c) {
            t[c] = face.corners[c].vertex;
            const auto& uv = original.texcoords[face.corners[c].texcoord];
            const bench::Rgb color = original.color(face, uv[0], uv[1]);
            for (std::size_t k = 0; k < 3; ++k) {
                colors[t[c]][k] = static_cast<std::uint16_t>(std::lround(color[k] * 65535));
            }
        }
        triangles.push_back(t);
    }
    const auto sink = create_mesh_file(path, {.overwrite = true});
    sink->begin(header);
    sink->add_vertices({positions, {}, colors});
    sink->add_triangles(triangles);
    sink->finish();
}

void run(std::vector<const char*> arguments) {
    const std::string mode = arguments.front();
    const char* const picture_path = mode == "--picture" ? arguments[1] : nullptr;
    if (picture_path != nullptr) arguments.erase(arguments.begin(), arguments.begin() + 2);
    if (mode == "--points") arguments.erase(arguments.begin());
    const TexturedObj original = bench::read_textured_obj(arguments.front());
    if (mode == "--points") {
        write_points(original, arguments[1]);
        return;
    }
    const Sphere sphere = bounding_sphere(original);
    const Draw draw_original = [&](Rasteriser& rasteriser) {
        for (const TexturedObj::Face& face : original.faces) {
            draw_textured(original, face, sphere.center, rasteriser);
        }
    };
    std::vector<Mesh> meshes;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        meshes.push_back(read_colored(arguments[i]));
    }
    std::vector<Draw> draws;
    for (const Mesh& mesh : meshes) {
        draws.emplace_back([&mesh, &sphere](Rasteriser& rasteriser) {
            draw_colored(mesh, sphere.center, rasteriser);
        });
    }
    if (picture_path == nullptr) {
        compare(draw_original, draws, sphere);
        return;
    }
    draws.insert(draws.begin(), draw_original);
    draw_side_by_side(picture_path, draws, sphere);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("usage: texture_rms [--points | --picture OUT.png] ORIGINAL.obj MESH.ply...\n",
                   stderr);
        return 2;
    }
    try {
        run({argv + 1, argv + argc});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "texture_rms: %s\n", error.what());
        return 1;
    } catch (const hewer::streaming::ImageProblem& problem) {
        std::fprintf(stderr, "texture_rms: %s\n", problem.what.c_str());
        return 1;
    }
    return 0;
}
