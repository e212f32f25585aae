// SPDX-License-Identifier: MIT
/// How far the components of a block are from each other.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rsimp/block_mesh.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/point_tree.h"

namespace hewer::rsimp {

/// The components and places are those of the mesh given, whatever becomes of it later. Memory:
/// kBytesPerVertex.
class PartDistance {
  public:
    static constexpr std::uint64_t kBytesPerVertex =
        PointTree::kBytesPerPoint + sizeof(Vec3) + 3 * sizeof(std::uint32_t);

    /// Faces of kNoIndex are gone; a vertex without a face is no point to be near to.
    PartDistance(std::span<const CollapseVertex> vertices, std::span<const LocalFace> faces);

    /// Square of the distance of a vertex with a face, which is `at` a place by now, from the
    /// nearest vertex of another component. Where the 64 nearest are all of its own component, from
    /// the farthest of these.
    double squared(std::uint32_t vertex, const Vec3& at);

  private:
    std::vector<std::uint32_t> part_;    // by vertex
    std::vector<std::uint32_t> vertex_;  // of each point
    std::unique_ptr<PointTree> tree_;
    std::vector<std::size_t> found_;
    std::vector<double> distances_;
};

}  // namespace hewer::rsimp
