// SPDX-License-Identifier: MIT
#include "batch_source.h"

#include <algorithm>
#include <utility>

#include "shapes.h"

namespace hewer::test {

BatchSource::BatchSource(const Mesh& mesh, const BatchPlan& plan)
    : mesh_(mesh),
      vertex_ranges_(cut(mesh.positions.size(), plan)),
      triangle_ranges_(cut(mesh.triangles.size(), plan)) {
    info_.name = "batches";
    info_.format = "memory";
    info_.is_indexed = !plan.is_soup;
    info_.n_vertices = plan.is_soup ? 0 : mesh.positions.size();
    info_.n_faces = mesh.triangles.size();
    info_.has_double_positions = true;
    info_.has_normals = !plan.is_soup && !mesh.normals.empty();
    info_.has_colors = !plan.is_soup && !mesh.colors.empty();
    info_.has_alpha = info_.has_colors;
    info_.has_weights = !plan.is_soup && !mesh.weights.empty();
}

std::vector<BatchSource::Range> BatchSource::cut(std::uint64_t n, const BatchPlan& plan) {
    Random random(plan.seed + 1);
    std::vector<Range> ranges;
    for (std::uint64_t first = 0; first < n;) {
        const std::uint64_t size = plan.smallest + random.below(plan.largest - plan.smallest + 1);
        ranges.push_back({first, std::min(n, first + size)});
        first += size;
    }
    if (plan.seed != 0) {
        for (std::size_t i = ranges.size(); i > 1; --i) {
            std::swap(ranges[i - 1], ranges[random.below(i)]);
        }
    }
    return ranges;
}

bool BatchSource::take(const std::vector<Range>& ranges, Range& range) {
    const std::lock_guard lock(mutex_);
    if (next_ == ranges.size()) return false;
    range = ranges[next_++];
    return true;
}

bool BatchSource::next_vertices(VertexBatch& batch) {
    Range range{};
    if (!take(vertex_ranges_, range)) return false;
    batch = {};
    batch.first = range.first;
    for (std::uint64_t i = range.first; i < range.last; ++i) {
        batch.positions.push_back(mesh_.positions[i]);
        if (!mesh_.normals.empty()) batch.normals.push_back(mesh_.normals[i]);
        if (!mesh_.colors.empty()) batch.colors.push_back(mesh_.colors[i]);
        if (!mesh_.weights.empty()) batch.weights.push_back(mesh_.weights[i]);
    }
    return true;
}

bool BatchSource::next_triangles(TriangleBatch& batch) {
    Range range{};
    if (!take(triangle_ranges_, range)) return false;
    batch = {};
    batch.first_face = range.first;
    batch.n_faces = range.last - range.first;
    for (std::uint64_t i = range.first; i < range.last; ++i) {
        const Triangle& t = mesh_.triangles[i];
        if (info_.is_indexed) {
            batch.corners.push_back(t);
        } else {
            batch.points.push_back(
                {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]});
        }
    }
    return true;
}

}  // namespace hewer::test
