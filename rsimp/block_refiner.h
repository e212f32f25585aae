// SPDX-License-Identifier: MIT
/// Refinement of all blocks of cells: each with its cluster tree, split down to one common
/// threshold.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/cluster_tree.h"

namespace hewer::rsimp {

/// Best-first refinement without a queue: with keys that never rise towards the leaves, the
/// clusters that a priority queue would hold after n splits are the cut at the n-th largest key. So
/// blocks grow by themselves down to a threshold that is lowered until there are enough leaves, and
/// the cut is chosen exactly among their keys. How far to go is found out on every eighth block
/// first.
///
/// A tree and its block stay in memory for the next step if there is room, else they are made
/// again: memory buys time. The result depends on the cells only. Memory: for each block at work
/// CellBlock::bytes_for() and kBytesPerCell.
class BlockRefiner {
  public:
    BlockRefiner(ooc::Context& context, const cluster::CellBlocks& cells, Priority priority);
    ~BlockRefiner();

    /// The cut with at most `n_clusters` clusters, and as many as that where the cells suffice. May
    /// be called again.
    ClusterMesh refine_to_count(std::uint64_t n_clusters);

    /// The cut in which no cluster's key is above `key`, where the cells suffice.
    ClusterMesh refine_to_key(double key);

  private:
    struct Grown;
    using Keys = std::vector<double>;

    [[nodiscard]] std::uint64_t bytes_for(std::size_t b) const;
    std::unique_ptr<Grown> take(std::size_t b, double threshold);
    void put_back(std::size_t b, std::unique_ptr<Grown> grown);
    std::uint64_t grow(const std::vector<std::size_t>& blocks, double threshold,
                       ooc::Spool<double>* keys);
    double threshold_for(const std::vector<std::size_t>& blocks, std::uint64_t n_clusters,
                         double threshold, ooc::Spool<double>* keys);
    ClusterMesh cut(double threshold);

    ooc::Context& context_;
    const cluster::CellBlocks& cells_;
    Priority priority_;
    std::size_t n_alive_;
    std::vector<std::unique_ptr<Grown>> kept_;
};

/// Every cell a cluster of its own, without a tree.
ClusterMesh cells_as_clusters(ooc::Context& context, const cluster::CellBlocks& cells);

}  // namespace hewer::rsimp
