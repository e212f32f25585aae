// SPDX-License-Identifier: MIT
#include "tests/bench/views.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "ooc/memory_budget.h"
#include "ooc/vec3.h"

namespace bench {

using namespace hewer;

namespace {

constexpr unsigned kSide = 256;
constexpr double kFill = 0.98;  // of half the picture, for the bounding sphere

Vec3 unit(const Vec3& v) {
    return (1 / std::sqrt(dot(v, v))) * v;
}

}  // namespace

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

raster::Camera camera_at(const Vec3& toward, double radius, unsigned side) {
    const Vec3 helper = std::abs(toward[2]) < 0.9 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    raster::Camera camera;
    camera.toward = toward;
    camera.right = unit(cross(helper, toward));
    camera.up = cross(toward, camera.right);
    camera.pixels_per_unit = kFill * 0.5 * side / radius;
    camera.depth_range = 1.5 * radius;  // a simplified mesh may reach beyond the original
    return camera;
}

Sphere bounding_sphere(std::span<const Vec3> points) {
    Vec3 low = points.front();
    Vec3 high = low;
    for (const Vec3& p : points) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const Vec3 diagonal = high - low;
    return {0.5 * (low + high), 0.5 * std::sqrt(dot(diagonal, diagonal))};
}

std::vector<std::uint8_t> render_views(const Sphere& sphere, const DrawModel& draw) {
    ooc::MemoryBudget budget(std::uint64_t{256} << 20);
    std::vector<std::uint8_t> pixels(std::size_t{3} * kSide * kSide);
    std::vector<std::uint8_t> views;
    for (const Vec3& toward : dodecahedron()) {
        const raster::Camera camera = camera_at(toward, sphere.radius, kSide);
        raster::Rasteriser rasteriser(budget, kSide, kSide, camera, {});
        draw(rasteriser, 1 / camera.pixels_per_unit);
        rasteriser.resolve(pixels);
        views.insert(views.end(), pixels.begin(), pixels.end());
    }
    return views;
}

}  // namespace bench
