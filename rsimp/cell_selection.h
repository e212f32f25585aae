// SPDX-License-Identifier: MIT
/// Some cells of a model as a model of their own.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>

#include "cluster/cell_blocks.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// The cells that stay, and their new ids. Memory: 12 bytes for 64 cells.
class KeptCells {
  public:
    KeptCells(ooc::MemoryBudget& budget, std::uint64_t n_cells)
        : bits_(budget, "cells that stay", n_cells / kWord + 1),
          before_(budget, "cells that stay", n_cells / kWord + 1) {}
    void keep(std::uint64_t cell) { bits_[cell / kWord] |= std::uint64_t{1} << (cell % kWord); }
    /// After the last keep().
    void number() {
        std::uint32_t n = 0;
        for (std::uint64_t w = 0; w < bits_.size(); ++w) {
            before_[w] = n;
            n += static_cast<std::uint32_t>(std::popcount(bits_[w]));
        }
    }
    [[nodiscard]] bool has(std::uint64_t cell) const {
        return (bits_[cell / kWord] >> (cell % kWord) & 1) != 0;
    }
    /// Precondition: it stays.
    [[nodiscard]] std::uint32_t id(std::uint64_t cell) const {
        const std::uint64_t below = (std::uint64_t{1} << (cell % kWord)) - 1;
        return before_[cell / kWord] +
               static_cast<std::uint32_t>(std::popcount(bits_[cell / kWord] & below));
    }

  private:
    static constexpr std::uint64_t kWord = 64;
    ooc::Array<std::uint64_t> bits_;
    ooc::Array<std::uint32_t> before_;
};

/// May change what a cell that stays stands for; `attributes` is null where there are none. Cells
/// come by rising id.
using ChangeCell = std::function<void(std::uint64_t cell, cluster::CellRecord& record,
                                      cluster::CellAttributes* attributes)>;

/// Appends the cells that stay to `to`, which is empty, and cuts its blocks; faces are the
/// caller's. `from` loses its cells on the way, its codes stay. `change` may be empty.
void copy_cells(ooc::Context& context, cluster::CellBlocks& from, const KeptCells& kept,
                const ChangeCell& change, std::uint64_t most_cells, cluster::CellBlocks& to);

/// The borders of the cells that are kept, under their new ids.
void copy_borders(const cluster::CellBlocks& from, const KeptCells& kept, cluster::CellBlocks& to);

}  // namespace hewer::rsimp
