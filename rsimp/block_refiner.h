// SPDX-License-Identifier: MIT
/// Refinement of all blocks of cells, each by its own cluster tree, down to one common threshold.
#pragma once

#include <cstdint>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/block_cut.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

/// Best-first refinement without a queue: with keys that never rise towards the leaves, the
/// clusters that a priority queue would hold after n splits are the cut at the n-th largest key. So
/// blocks grow by themselves down to a threshold at which there are enough clusters, and the cut is
/// chosen exactly among their keys. How far to go is found out on every eighth block, which is
/// split as often as its share of the cells calls for and more; usually one sweep over the other
/// blocks then suffices, and those of build_cluster_mesh() make the clusters.
///
/// Between sweeps a block is its BlockCut, on spools: 2 bytes a cell and 10 a cluster. No tree is
/// kept, and none is grown twice: a lower threshold grows it on from the cut. The result depends on
/// the cells only.
///
/// Memory: for each block in flight BlockTree::bytes_for(), a cut of 14 bytes a cell, and
/// BlockTree::kBytesPerSplit a cell for the sample; then what build_cluster_mesh() takes.
class BlockRefiner {
  public:
    /// `blocks` must outlive the refiner.
    BlockRefiner(ooc::Context& context, const cluster::CellBlocks& blocks, Priority priority);

    /// The cut with at most `n_clusters` clusters, and as many as that where the cells suffice
    /// (fewer only where splits with equal keys would exceed it); at least one for each block. May
    /// be called again.
    ClusterMesh refine_to_count(std::uint64_t n_clusters);

    /// The cut in which no cluster's key is above `key`, where the cells suffice.
    ClusterMesh refine_to_key(double key);

  private:
    /// The cuts of all blocks.
    struct Cuts {
        // Parts of BlockCut, one block after the other.
        ooc::Spool<LocalCell> order;
        ooc::Spool<LocalCell> begins;
        ooc::Spool<double> keys;
        struct Block {
            std::uint64_t first_cell = 0;   // in `order`
            std::uint64_t first_split = 0;  // in `begins` and `keys`
            double threshold = 0;
        };
        std::vector<Block> blocks;  // one more at the end

        explicit Cuts(ooc::Context& context);
        void read(std::size_t b, BlockCut& cut) const;
        void append(const BlockCut& cut);
        /// The key down to which all keys are there.
        [[nodiscard]] double threshold() const;
    };
    template <typename Grow>
    void sweep(std::size_t stride, std::uint64_t bytes_per_cell, const Grow& grow);
    void grow_to_key(double threshold);
    void grow_sample(std::uint64_t n_splits);
    void grow_to_splits(std::uint64_t n_splits);
    [[nodiscard]] std::uint64_t n_keys_above(double key) const;
    [[nodiscard]] double nth_key(std::uint64_t n);
    ClusterMesh make_clusters(double threshold);

    ooc::Context& context_;
    const cluster::CellBlocks& blocks_;
    Priority priority_;
    Cuts cuts_;
};

}  // namespace hewer::rsimp
