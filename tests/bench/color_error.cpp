// SPDX-License-Identifier: MIT
/// How far the colours of simplified meshes are from those of the original.
///
///     color_error ORIGINAL SIMPLIFIED...
///
/// Prints a JSON array, for each simplified mesh:
///   surface  root of the mean squared difference (0..255, over red, green and blue) between a
///            vertex of the original and the colour of the simplified mesh at the point nearest to
///            it, interpolated in its triangle; a vertex counts with the area around it
///   picture  the same over all pixels of the twenty views of image_rms, colours interpolated
/// Readers, nearest faces and rasteriser are the product's own.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/memory_budget.h"
#include "ooc/vec3.h"
#include "rsimp/face_tree.h"
#include "tests/bench/views.h"

namespace {

using namespace hewer;

/// 0..1.
using Rgb = std::array<float, 3>;

struct ColoredMesh {
    std::vector<Vec3> positions;
    std::vector<Rgb> colors;
    std::vector<std::array<std::uint32_t, 3>> faces;
};

ColoredMesh read(const std::string& path) {
    const auto source = open_mesh(path);
    if (!source->info().has_colors || !source->info().is_indexed) {
        throw std::runtime_error(path + ": has no colours of vertices");
    }
    ColoredMesh mesh;
    source->begin_vertices();
    for (VertexBatch batch; source->next_vertices(batch);) {
        mesh.positions.insert(mesh.positions.end(), batch.positions.begin(), batch.positions.end());
        for (const Rgba16& c : batch.colors) {
            constexpr float kUnit = 1.0F / 65535;
            mesh.colors.push_back({kUnit * c[0], kUnit * c[1], kUnit * c[2]});
        }
    }
    source->begin_triangles();
    for (TriangleBatch batch; source->next_triangles(batch);) {
        for (const Triangle& t : batch.corners) {
            mesh.faces.push_back({static_cast<std::uint32_t>(t[0]),
                                  static_cast<std::uint32_t>(t[1]),
                                  static_cast<std::uint32_t>(t[2])});
        }
    }
    return mesh;
}

std::vector<double> vertex_areas(const ColoredMesh& mesh) {
    std::vector<double> areas(mesh.positions.size());
    for (const auto& f : mesh.faces) {
        const Vec3 n = cross(mesh.positions[f[1]] - mesh.positions[f[0]],
                             mesh.positions[f[2]] - mesh.positions[f[0]]);
        for (const std::uint32_t v : f) areas[v] += std::sqrt(dot(n, n));
    }
    return areas;
}

/// Barycentric weights of the point of the triangle that is nearest to p, to within what clamping
/// each does.
std::array<double, 3> weights_at(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 ap = p - a;
    const double d00 = dot(ab, ab);
    const double d01 = dot(ab, ac);
    const double d11 = dot(ac, ac);
    const double det = d00 * d11 - d01 * d01;
    std::array<double, 3> w{1, 0, 0};
    if (det > 0) {
        w[1] = (d11 * dot(ab, ap) - d01 * dot(ac, ap)) / det;
        w[2] = (d00 * dot(ac, ap) - d01 * dot(ab, ap)) / det;
        w[0] = 1 - w[1] - w[2];
    }
    double sum = 0;
    for (double& x : w) sum += x = std::max(x, 0.0);
    for (double& x : w) x /= sum;
    return w;
}

double surface_error(const ColoredMesh& original, const std::vector<double>& areas,
                     const ColoredMesh& mesh) {
    // Near the origin single precision suffices.
    const Vec3 center = original.positions[0];
    std::vector<rsimp::Point3f> points;
    for (const Vec3& p : mesh.positions) points.push_back(rsimp::to_single(p - center));
    const rsimp::FaceTree tree(points, mesh.faces);
    double sum = 0;
    double area = 0;
    std::uint32_t guess = 0;
    for (std::size_t v = 0; v < original.positions.size(); ++v) {
        if (!(areas[v] > 0)) continue;
        const auto hit = tree.nearest(rsimp::to_single(original.positions[v] - center),
                                      std::numeric_limits<float>::max(), guess);
        guess = hit.slot;
        const auto& f = mesh.faces[hit.face];
        const auto w = weights_at(original.positions[v], mesh.positions[f[0]], mesh.positions[f[1]],
                                  mesh.positions[f[2]]);
        for (std::size_t k = 0; k < 3; ++k) {
            double color = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                color += w[c] * static_cast<double>(mesh.colors[f[c]][k]);
            }
            const double d = color - static_cast<double>(original.colors[v][k]);
            sum += areas[v] * d * d;
        }
        area += areas[v];
    }
    return 255 * std::sqrt(sum / (3 * area));
}

std::vector<std::uint8_t> pictures(const ColoredMesh& mesh, const bench::Sphere& sphere) {
    return bench::render_views(sphere, [&](raster::Rasteriser& rasteriser, double /*pixel*/) {
        for (const auto& f : mesh.faces) {
            const raster::Rasteriser::Paint paint{mesh.colors[f[0]], mesh.colors[f[1]],
                                                  mesh.colors[f[2]]};
            rasteriser.draw(
                {mesh.positions[f[0]] - sphere.center, mesh.positions[f[1]] - sphere.center,
                 mesh.positions[f[2]] - sphere.center},
                &paint);
        }
    });
}

double rms(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
        sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fputs("usage: color_error ORIGINAL SIMPLIFIED...\n", stderr);
        return 2;
    }
    try {
        const ColoredMesh original = read(argv[1]);
        const std::vector<double> areas = vertex_areas(original);
        const bench::Sphere sphere = bench::bounding_sphere(original.positions);
        const auto original_pictures = pictures(original, sphere);
        nlohmann::json result = nlohmann::json::array();
        for (int i = 2; i < argc; ++i) {
            const ColoredMesh mesh = read(argv[i]);
            result.push_back({{"surface", surface_error(original, areas, mesh)},
                              {"picture", rms(original_pictures, pictures(mesh, sphere))}});
        }
        std::puts(result.dump().c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "color_error: %s\n", error.what());
        return 1;
    }
    return 0;
}
