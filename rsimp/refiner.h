// SPDX-License-Identifier: MIT
/// Refinement of the whole cell store: blocks of cells, each with its cluster tree, split down to
/// one common threshold.
#pragma once

#include <cstdint>
#include <vector>

#include "cluster/cell_store.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/cluster_tree.h"
#include "rsimp/clusters.h"

namespace hewer::rsimp {

/// Best-first refinement without a queue: with keys that never rise towards the leaves, the
/// clusters that a priority queue would hold after n splits are the cut at the n-th largest key. So
/// blocks grow in parallel down to a threshold that is lowered until there are enough leaves, and
/// the cut is chosen exactly among their keys. The result depends on the store only.
///
/// Blocks are octree boxes (Morton prefixes) of at most kBlockCells cells: small enough for a
/// core's cache, independent of each other, and the unit that an out-of-core run will load. Memory:
/// 4 bytes a cell, 80 bytes a tree node (about 2.2 for each cluster asked for), a second copy of
/// the triples while they are sorted into blocks.
class Refiner {
  public:
    static constexpr std::uint64_t kBlockCells = 1 << 15;

    /// Sorts the store's triangles into the blocks that own them.
    Refiner(ooc::Context& context, cluster::CellStore& store, Priority priority);

    /// The cut with at most `n_clusters` clusters, and as many as that where the cells suffice.
    Clusters refine_to_count(std::uint64_t n_clusters);

    /// The cut in which no cluster's key is above `key`, where the cells suffice.
    Clusters refine_to_key(double key);

    [[nodiscard]] std::uint64_t n_blocks() const { return trees_.size(); }

  private:
    void grow(double threshold);
    void reserve_nodes();
    [[nodiscard]] std::uint64_t n_leaves() const;
    [[nodiscard]] double cut_threshold(std::uint64_t n_clusters) const;
    Clusters cut(double threshold);

    ooc::Context& context_;
    cluster::CellStore& store_;
    Priority priority_;
    ooc::Array<std::uint32_t> position_;
    std::vector<ClusterTree> trees_;
    ooc::Reservation node_bytes_;
};

}  // namespace hewer::rsimp
