// SPDX-License-Identifier: MIT
#include "measure/census.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "hewer/error.h"
#include "measure/points.h"
#include "ooc/exact_sum.h"

namespace hewer::measuring {

namespace {

struct Part {
    std::uint64_t n_triangles = 0;
    Bounds bounds;
    ooc::ExactSum area;
};

double area_of(const std::array<Vec3, 3>& t) {
    Vec3 u{};
    Vec3 v{};
    for (std::size_t k = 0; k < 3; ++k) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
    }
    return 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                            u[0] * v[1] - u[1] * v[0]);
}

}  // namespace

Census take_census(ooc::Context& context, MeshSource& source, std::uint64_t window_bytes) {
    Census census;
    census.used =
        Marks(context, "marks of used vertices of " + source.info().name, source.info().n_vertices);
    std::vector<Part> parts;
    streaming::Dereference<ModelEncoder> triangles(context, source, {}, window_bytes);
    triangles.for_batches(
        [&] {
            parts.assign(context.n_threads(), {});
            census.used.clear();
        },
        [&](unsigned worker, std::span<const std::array<Vec3, 3>> points,
            std::span<const Triangle> ids) {
            Part& part = parts[worker];
            part.n_triangles += points.size();
            for (const auto& t : points) {
                for (const Vec3& p : t) part.bounds.extend(p);
                const double area = area_of(t);
                if (std::isfinite(area)) part.area.add(area);
            }
            for (const Triangle& t : ids) {
                for (const std::uint64_t v : t) census.used.set(v);
            }
        });
    ooc::ExactSum area;
    for (const Part& part : parts) {
        census.n_triangles += part.n_triangles;
        census.bounds.extend(part.bounds);
        area.add(part.area);
    }
    census.area = area.value();
    for (std::uint64_t v = 0; v < source.info().n_vertices; ++v) {
        if (census.used.get(v)) ++census.n_vertices;
    }
    census.coherence = triangles.coherence();
    return census;
}

Census take_census_of_surface(ooc::Context& context, MeshSource& source,
                              std::uint64_t window_bytes) {
    Census census = take_census(context, source, window_bytes);
    if (census.n_triangles == 0) {
        throw InvalidArgument(source.info().name +
                              ": has no triangle with finite corners, so no surface to measure");
    }
    return census;
}

}  // namespace hewer::measuring
