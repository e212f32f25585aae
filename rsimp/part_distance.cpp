// SPDX-License-Identifier: MIT
#include "rsimp/part_distance.h"

#include <algorithm>

#include "rsimp/face_components.h"

namespace hewer::rsimp {

namespace {

constexpr std::size_t kNeighbours = 64;

std::vector<LocalFace> faces_there(std::span<const LocalFace> faces) {
    std::vector<LocalFace> there;
    for (const LocalFace& t : faces) {
        if (t[0] != kNoIndex) there.push_back(t);
    }
    return there;
}

std::vector<std::uint32_t> vertices_of(std::size_t n, std::span<const LocalFace> faces) {
    std::vector<bool> has_face(n);
    for (const LocalFace& t : faces) {
        if (t[0] == kNoIndex) continue;
        for (const std::uint32_t v : t) has_face[v] = true;
    }
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < n; ++v) {
        if (has_face[v]) vertices.push_back(v);
    }
    return vertices;
}

std::vector<Vec3> positions_of(std::span<const CollapseVertex> vertices,
                               const std::vector<std::uint32_t>& chosen) {
    std::vector<Vec3> positions;
    positions.reserve(chosen.size());
    for (const std::uint32_t v : chosen) positions.push_back(vertices[v].position);
    return positions;
}

}  // namespace

PartDistance::PartDistance(std::span<const CollapseVertex> vertices,
                           std::span<const LocalFace> faces)
    : part_(component_labels(vertices.size(), faces_there(faces))),
      owner_(vertices_of(vertices.size(), faces)),
      points_(positions_of(vertices, owner_)),
      tree_(points_) {}

double PartDistance::squared(std::uint32_t vertex) {
    const auto point = static_cast<std::size_t>(
        std::lower_bound(owner_.begin(), owner_.end(), vertex) - owner_.begin());
    const std::size_t n = std::min(kNeighbours, points_.size());
    tree_.nearest(points_[point], n, found_, distances_);
    for (std::size_t i = 0; i < n; ++i) {
        if (part_[owner_[found_[i]]] != part_[vertex]) return distances_[i];
    }
    return distances_.back();
}

}  // namespace hewer::rsimp
