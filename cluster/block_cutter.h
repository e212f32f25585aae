// SPDX-License-Identifier: MIT
/// Cuts a stream of cells in Morton order into octree boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/cell_blocks.h"

namespace hewer::cluster {

/// Appends codes to CellBlocks::codes and blocks to CellBlocks::blocks. The blocks are the largest
/// octree boxes of at most `most_cells` cells, as if they were found from the root down: the block
/// that begins with a code is the largest box around it that holds at most so many and does not
/// reach back to the code before. Memory: 8 * most_cells bytes.
class BlockCutter {
  public:
    BlockCutter(CellBlocks& blocks, std::uint64_t most_cells)
        : blocks_(blocks), most_cells_(most_cells) {}

    /// Rising codes; more than before.
    void add(std::span<const std::uint64_t> codes);
    /// After the last; the total goes to the end of the list of blocks.
    void finish();

  private:
    void cut_first();

    CellBlocks& blocks_;
    std::uint64_t most_cells_;
    std::vector<std::uint64_t> waiting_;  // codes that have no block yet
    std::size_t begin_ = 0;               // of them in the vector
    std::uint64_t n_cut_ = 0;
    std::uint64_t last_cut_ = 0;  // code
};

}  // namespace hewer::cluster
