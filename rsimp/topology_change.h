// SPDX-License-Identifier: MIT
/// Below what its topology allows: what goes when edges can collapse no further. Whole meshes in
/// memory; those are small.
#pragma once

#include <cstdint>

#include "ooc/context.h"
#include "rsimp/block_mesh.h"
#include "rsimp/finish.h"

namespace hewer::rsimp {

/// The mesh in memory, which must have room for it: 144 bytes a vertex and 12 a face.
class WholeMesh {
  public:
    WholeMesh(ooc::Context& context, const MeshStore& store);

    /// Removes whole components, smallest box first, until the target is met. At least one
    /// component stays. What went is added to `report`.
    void drop_components(const CollapseTarget& target, FinishReport& report);

    /// Merges the ends of the cheapest edges, each vertex at most once, half as many pairs as are
    /// missing for the target, without asking for the type of the surface, and makes what is left
    /// manifold again: handles close and thin parts vanish, but nothing is opened. False, and the
    /// mesh is as before, if nothing would be left. Vertices that went are added to the merges of
    /// `report`, those of which no face is left to what is lost.
    bool merge_regardless(const CollapseTarget& target, bool is_closed, FinishReport& report);

    [[nodiscard]] bool is_met(const CollapseTarget& target) const {
        return mesh_.faces.size() <= target.most_triangles &&
               mesh_.vertices.size() <= target.most_vertices;
    }
    [[nodiscard]] MeshStore store() const;

  private:
    ooc::Context& context_;
    ooc::Reservation bytes_;
    Vec3 origin_;
    BlockMesh mesh_;
    std::uint64_t next_fan_ = std::uint64_t{1} << (kFanBits - 1);
};

}  // namespace hewer::rsimp
