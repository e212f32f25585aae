// SPDX-License-Identifier: MIT
/// Cells with faces, and the cells around a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "cluster/cell_blocks.h"
#include "cluster/code_lookup.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// A bit for each cell that a surviving triangle has a corner in. One sweep over the faces.
class FacedCells {
  public:
    FacedCells(ooc::Context& context, const cluster::CellBlocks& cells);
    [[nodiscard]] bool has(std::uint64_t cell) const {
        return (bits_[cell / 64] >> (cell % 64) & 1) != 0;
    }

  private:
    void mark(std::uint64_t cell);
    ooc::Array<std::uint64_t> bits_;
};

/// visit(code) for the up to 26 cells around one until it returns true.
template <typename Visit>
bool any_neighbour(std::uint64_t code, const Visit& visit) {
    constexpr std::uint32_t kMost = (1U << 21) - 1;
    const auto c = cluster::unpack_morton(code);
    for (std::uint32_t i = 0; i < 27; ++i) {
        // Each axis by 0, +1, -1.
        const std::array<std::uint32_t, 3> step{i % 3, i / 3 % 3, i / 9};
        std::array<std::uint32_t, 3> n{};
        bool is_there = i != 0;
        for (std::size_t k = 0; k < 3; ++k) {
            is_there = is_there && (step[k] != 1 || c[k] < kMost) && (step[k] != 2 || c[k] > 0);
            n[k] = step[k] == 2 ? c[k] - 1 : c[k] + step[k];
        }
        if (!is_there) continue;
        if (visit(cluster::spread_bits(n[0]) | cluster::spread_bits(n[1]) << 1 |
                  cluster::spread_bits(n[2]) << 2)) {
            return true;
        }
    }
    return false;
}

}  // namespace hewer::rsimp
