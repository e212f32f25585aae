// SPDX-License-Identifier: MIT
#include "measure/query_points.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {
constexpr std::uint64_t kPerTask = 1 << 16;  // triangles
}  // namespace

QueryPoints make_query_points(ooc::Context& context, std::span<const LatticePoint> vertices,
                              std::span<const LatticeTriangle> triangles,
                              const AreaSampler& sampler) {
    const std::uint64_t n_tasks = (triangles.size() + kPerTask - 1) / kPerTask;
    const auto triangles_of = [&](std::uint64_t task) {
        const std::uint64_t at = task * kPerTask;
        return triangles.subspan(at, std::min(kPerTask, triangles.size() - at));
    };
    std::vector<std::uint64_t> first(n_tasks + 1, 0);  // place of each task's first sample
    context.workers().for_ranges(n_tasks, 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t task = begin; task < end; ++task) {
            for (const LatticeTriangle& t : triangles_of(task)) first[task + 1] += sampler.count(t);
        }
    });
    first[0] = vertices.size();
    std::partial_sum(first.begin(), first.end(), first.begin());

    QueryPoints query;
    query.n_vertices = vertices.size();
    query.points = {context.budget(), "points to measure from", first.back()};
    std::transform(vertices.begin(), vertices.end(), query.points.begin(), to_double);
    context.workers().for_ranges(n_tasks, 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t task = begin; task < end; ++task) {
            Vec3* out = query.points.begin() + first[task];
            for (const LatticeTriangle& t : triangles_of(task)) {
                sampler.for_samples(t, [&](const Vec3& q) { *out++ = q; });
            }
        }
    });
    return query;
}

}  // namespace hewer::measuring
