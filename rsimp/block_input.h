// SPDX-License-Identifier: MIT
/// What the finishing collapse begins with, box by box: the mesh of the clusters, or a level of
/// detail made before.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/context.h"
#include "rsimp/block_mesh.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A mesh over a row of octree boxes. Any thread may load.
class BlockInput {
  public:
    virtual ~BlockInput() = default;
    [[nodiscard]] virtual Vec3 origin() const = 0;
    [[nodiscard]] virtual AttributeKinds attributes() const = 0;
    /// Vertices in each box.
    [[nodiscard]] virtual const std::vector<std::uint64_t>& counts() const = 0;
    /// The boxes [first, last) as one mesh: their vertices, and the faces all of whose corners are
    /// among them; also faces (A, B, B) for raw clusters that were neighbours, if that is known.
    [[nodiscard]] virtual BlockMesh load(std::size_t first, std::size_t last) const = 0;
    /// Of the faces listed in these boxes those that load() leaves out. Every face is listed in one
    /// box.
    [[nodiscard]] virtual std::vector<Face> crossing(std::size_t first, std::size_t last) const = 0;
};

class ClusterInput final : public BlockInput {
  public:
    explicit ClusterInput(const ClusterMesh& mesh);
    [[nodiscard]] Vec3 origin() const override { return mesh_.origin; }
    [[nodiscard]] AttributeKinds attributes() const override { return mesh_.attributes.kinds(); }
    [[nodiscard]] const std::vector<std::uint64_t>& counts() const override { return counts_; }
    [[nodiscard]] BlockMesh load(std::size_t first, std::size_t last) const override;
    [[nodiscard]] std::vector<Face> crossing(std::size_t first, std::size_t last) const override;

  private:
    const ClusterMesh& mesh_;
    std::vector<std::uint64_t> counts_;
};

class StoreInput final : public BlockInput {
  public:
    /// `first_cluster` of each box, and the end. One pass over the mesh.
    StoreInput(const MeshStore& mesh, std::span<const std::uint64_t> first_cluster);
    [[nodiscard]] Vec3 origin() const override { return mesh_.origin; }
    [[nodiscard]] AttributeKinds attributes() const override { return mesh_.attributes.kinds(); }
    [[nodiscard]] const std::vector<std::uint64_t>& counts() const override { return counts_; }
    [[nodiscard]] BlockMesh load(std::size_t first, std::size_t last) const override;
    [[nodiscard]] std::vector<Face> crossing(std::size_t first, std::size_t last) const override;

  private:
    const MeshStore& mesh_;
    std::vector<std::uint64_t> first_cluster_;
    std::vector<std::uint64_t> counts_;
    std::vector<std::uint64_t> first_vertex_;  // of each box, and the end
    std::vector<std::uint64_t> first_face_;
};

}  // namespace hewer::rsimp
