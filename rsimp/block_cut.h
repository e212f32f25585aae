// SPDX-License-Identifier: MIT
/// A cut of the cluster tree of one block, without the tree.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "cluster/cell_blocks.h"

namespace hewer::rsimp {

/// Place of a cell in its block.
using LocalCell = std::uint16_t;
static_assert(cluster::CellBlocks::kMostCells <= 1 << 16);

/// The clusters of a block as contiguous runs of its cells. Keys never rise towards the leaves of
/// the tree, so the cut at any higher threshold is here as well: its clusters begin where the key
/// is above that threshold. 2 bytes a cell and 10 a cluster say all that a tree of nodes would.
struct BlockCut {
    /// The cells, cluster by cluster; empty: in the order of the block.
    std::vector<LocalCell> order;
    /// Places in `order` at which the clusters begin, but for the first, which begins at 0.
    std::vector<LocalCell> begins;
    /// By `begins`: the key of the split that parted the cluster from the one before it.
    std::vector<double> keys;
    /// No cluster has a key above this (a single cell has none).
    double threshold = std::numeric_limits<double>::infinity();
};

}  // namespace hewer::rsimp
