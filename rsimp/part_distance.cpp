// SPDX-License-Identifier: MIT
#include "rsimp/part_distance.h"

#include <algorithm>

#include "rsimp/face_components.h"

namespace hewer::rsimp {

namespace {

constexpr std::size_t kNeighbours = 64;

}  // namespace

PartDistance::PartDistance(std::span<const CollapseVertex> vertices,
                           std::span<const LocalFace> faces) {
    std::vector<LocalFace> there;
    std::vector<bool> has_face(vertices.size());
    for (const LocalFace& t : faces) {
        if (t[0] == kNoIndex) continue;
        there.push_back(t);
        for (const std::uint32_t v : t) has_face[v] = true;
    }
    part_ = component_labels(vertices.size(), there);
    std::vector<Vec3> points;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
        if (!has_face[v]) continue;
        vertex_.push_back(v);
        points.push_back(vertices[v].position);
    }
    tree_ = std::make_unique<PointTree>(points);
}

double PartDistance::squared(std::uint32_t vertex, const Vec3& at) {
    const std::size_t n = std::min(kNeighbours, vertex_.size());
    tree_->nearest(at, n, found_, distances_);
    for (std::size_t i = 0; i < n; ++i) {
        if (part_[vertex_[found_[i]]] != part_[vertex]) return distances_[i];
    }
    return distances_.back();
}

}  // namespace hewer::rsimp
