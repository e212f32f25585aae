// SPDX-License-Identifier: MIT
/// The finishing edge collapse on a mesh of any size: in blocks, level by level.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "ooc/context.h"
#include "rsimp/block_input.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/lost_parts.h"
#include "rsimp/manifold.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Where to stop; whichever comes last.
struct CollapseTarget {
    std::uint64_t most_triangles = 0;
    std::uint64_t most_vertices = 0;
    CollapseRules rules;
};

struct FinishReport {
    std::uint64_t collapses = 0;
    std::uint64_t joined_necks = 0;
    std::uint64_t lost_cells = 0;  ///< of clusters of which no face was left
    ooc::Spool<LostPart> lost;     ///< these clusters, and whatever else went
    /// (went, stands for it), if asked for; a pair's second may be the first of a later one.
    std::vector<std::pair<VertexId, VertexId>> merges;
};

/// On the first level the boxes of the input are grouped into blocks of some ten thousand vertices.
/// A block's vertices are free unless a face reaches from them into another block; raw clusters get
/// their fans (rsimp/manifold.h), edges collapse (rsimp/block_collapse.h). What is farther than a
/// few edges from the frozen vertices is finished then. The rest of all blocks, a few per cent,
/// makes the next level, in larger octree boxes, where most of what was frozen is free; and so on,
/// until one block is left. So each vertex is free once at least with all that surrounds it, no
/// vertex is at a seam in the end, memory holds a block for each thread, and the mesh is read and
/// written about once. The size of the blocks is fixed: memory and threads change nothing.
///
/// Differs from Hoppe's (1998) and Cignoni et al.'s (2003) external memory schemes: the seams are
/// simplified to the same cost as the rest, in the same pass.
class Finisher {
  public:
    static constexpr std::uint64_t kBlockVertices = 1 << 15;

    /// `boxes` are those of the input, in Morton order; `first_cluster` of each, and the end.
    Finisher(ooc::Context& context, std::vector<cluster::OctreeBox> boxes,
             std::vector<std::uint64_t> first_cluster, SurfaceKind kind,
             std::uint64_t block_vertices = kBlockVertices);

    ~Finisher();

    /// Makes the blocks of the first level manifold. The input is not needed any more afterwards.
    /// Returns how many triangles a collapse could begin with: an estimate at the seams.
    std::uint64_t begin(const BlockInput& input, FinishReport& report);

    /// Collapses what begin() has loaded until the target is met or no edge can be collapsed any
    /// more; without a target it only makes the mesh manifold.
    MeshStore run(const std::optional<CollapseTarget>& target, bool with_merges,
                  FinishReport& report);

    [[nodiscard]] const std::vector<cluster::OctreeBox>& boxes() const { return boxes_; }
    [[nodiscard]] const std::vector<std::uint64_t>& first_cluster() const { return first_cluster_; }

  private:
    class Level;

    ooc::Context& context_;
    std::vector<cluster::OctreeBox> boxes_;
    std::vector<std::uint64_t> first_cluster_;
    SurfaceKind kind_;
    std::uint64_t block_vertices_;
    Vec3 origin_{};
    std::unique_ptr<Level> level_;
};

}  // namespace hewer::rsimp
