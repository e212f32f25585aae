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
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <vector>

#include "ooc/vec3.h"
#include "tests/bench/plain_ply.h"
#include "tests/bench/views.h"

namespace {

using namespace hewer;

/// Luminance of all pixels of all views, one view after the other.
using Views = std::vector<float>;

Vec3 position(const bench::PlainMesh& mesh, std::size_t vertex) {
    const float* p = &mesh.positions[3 * vertex];
    return {p[0], p[1], p[2]};
}

bench::Sphere sphere_around(const bench::PlainMesh& mesh) {
    std::vector<Vec3> points;
    for (std::size_t v = 0; 3 * v < mesh.positions.size(); ++v) points.push_back(position(mesh, v));
    return bench::bounding_sphere(points);
}

Views render(const bench::PlainMesh& mesh, const bench::Sphere& sphere) {
    const std::vector<std::uint8_t> pixels =
        bench::render_views(sphere, [&](raster::Rasteriser& rasteriser, double) {
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                rasteriser.draw({position(mesh, mesh.indices[t]) - sphere.center,
                                 position(mesh, mesh.indices[t + 1]) - sphere.center,
                                 position(mesh, mesh.indices[t + 2]) - sphere.center},
                                nullptr);
            }
        });
    Views views;
    for (std::size_t i = 0; i < pixels.size(); i += 3) {  // ITU-R BT.601
        views.push_back(0.299F * static_cast<float>(pixels[i]) +
                        0.587F * static_cast<float>(pixels[i + 1]) +
                        0.114F * static_cast<float>(pixels[i + 2]));
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
        bench::Sphere sphere;
        Views original;
        {
            const bench::PlainMesh mesh = bench::read_plain_ply(argv[1]);
            sphere = sphere_around(mesh);
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
