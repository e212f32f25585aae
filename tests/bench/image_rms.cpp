// SPDX-License-Identifier: MIT
/// How much pictures of simplified meshes differ from those of the original: the measure of
/// Lindstrom & Turk 2000 ("Image-driven simplification").
///
///     image_rms ORIGINAL.ply SIMPLIFIED.ply...
///
/// Twenty views of 256 x 256 pixels, from the vertices of a dodecahedron around the original's box;
/// the same cameras for all meshes. Prints a JSON array: for each simplified mesh the root of the
/// mean squared difference of luminance (0..255) over all pixels of all views. Flat shading, by the
/// rasteriser of `hewer render`: the only part of the product that is linked into a judge, and the
/// same for all that it judges.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <vector>

#include "ooc/memory_budget.h"
#include "ooc/vec3.h"
#include "render/rasteriser.h"
#include "tests/bench/plain_ply.h"

namespace {

using namespace hewer;

constexpr unsigned kSide = 256;
constexpr double kFill = 0.98;  // of half the picture, for the bounding sphere

/// Luminance of all pixels of all views, one view after the other.
using Views = std::vector<float>;

Vec3 unit(const Vec3& v) {
    return (1 / std::sqrt(dot(v, v))) * v;
}

/// Directions to the vertices: those of a cube, and of three golden rectangles.
std::vector<Vec3> dodecahedron() {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> vertices;
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            for (const double z : {-1.0, 1.0}) vertices.push_back(unit({x, y, z}));
            const Vec3 p{0, x / golden, y * golden};
            for (std::size_t turn = 0; turn < 3; ++turn) {
                vertices.push_back(unit({p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]}));
            }
        }
    }
    return vertices;
}

struct Sphere {
    Vec3 center{};
    double radius = 0;
};

Vec3 position(const bench::PlainMesh& mesh, std::size_t vertex) {
    const float* p = &mesh.positions[3 * vertex];
    return {p[0], p[1], p[2]};
}

/// Around the box of all vertices.
Sphere bounding_sphere(const bench::PlainMesh& mesh) {
    Vec3 low = position(mesh, 0);
    Vec3 high = low;
    for (std::size_t v = 1; 3 * v < mesh.positions.size(); ++v) {
        const Vec3 p = position(mesh, v);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const Vec3 diagonal = high - low;
    return {0.5 * (low + high), 0.5 * std::sqrt(dot(diagonal, diagonal))};
}

raster::Camera camera_at(const Vec3& toward, double radius) {
    const Vec3 helper = std::abs(toward[2]) < 0.9 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    raster::Camera camera;
    camera.toward = toward;
    camera.right = unit(cross(helper, toward));
    camera.up = cross(toward, camera.right);
    camera.pixels_per_unit = kFill * 0.5 * kSide / radius;
    camera.depth_range = 1.5 * radius;  // a simplified mesh may reach beyond the original
    return camera;
}

Views render(const bench::PlainMesh& mesh, const Sphere& sphere) {
    ooc::MemoryBudget budget(std::uint64_t{256} << 20);
    std::vector<std::uint8_t> pixels(std::size_t{3} * kSide * kSide);
    Views views;
    for (const Vec3& toward : dodecahedron()) {
        raster::Rasteriser rasteriser(budget, kSide, kSide, camera_at(toward, sphere.radius), {});
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            rasteriser.draw({position(mesh, mesh.indices[t]) - sphere.center,
                             position(mesh, mesh.indices[t + 1]) - sphere.center,
                             position(mesh, mesh.indices[t + 2]) - sphere.center},
                            nullptr);
        }
        rasteriser.resolve(pixels);
        for (std::size_t i = 0; i < pixels.size(); i += 3) {  // ITU-R BT.601
            views.push_back(0.299F * static_cast<float>(pixels[i]) +
                            0.587F * static_cast<float>(pixels[i + 1]) +
                            0.114F * static_cast<float>(pixels[i + 2]));
        }
    }
    return views;
}

double rms(const Views& a, const Views& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double difference = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += difference * difference;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("usage: image_rms ORIGINAL.ply SIMPLIFIED.ply...\n", stderr);
        return 2;
    }
    try {
        Sphere sphere;
        Views original;
        {
            const bench::PlainMesh mesh = bench::read_plain_ply(argv[1]);
            sphere = bounding_sphere(mesh);
            original = render(mesh, sphere);
        }
        nlohmann::json result = nlohmann::json::array();
        for (int i = 2; i < argc; ++i) {
            result.push_back(rms(original, render(bench::read_plain_ply(argv[i]), sphere)));
        }
        std::puts(result.dump().c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "image_rms: %s\n", error.what());
        return 1;
    }
    return 0;
}
