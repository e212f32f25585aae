// SPDX-License-Identifier: MIT
#include "rsimp/cell_neighbours.h"

#include <atomic>

#include "ooc/parallel.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

using cluster::CellTriple;

FacedCells::FacedCells(ooc::Context& context, const cluster::CellBlocks& cells)
    : bits_(context.budget(), "cells with faces", (cells.n_cells() + 63) / 64) {
    context.workers().for_ranges(cells.n_blocks(), 1, [&](std::uint64_t first, std::uint64_t last) {
        ooc::SpoolReader<CellTriple> faces(cells.faces, cells.blocks[first].first_face,
                                           cells.blocks[last].first_face);
        for (auto piece = faces.next_piece(); !piece.empty(); piece = faces.next_piece()) {
            for (const CellTriple& face : piece) {
                for (const std::uint32_t cell : face) mark(cell);
            }
        }
        context.check_stop();
    });
}

void FacedCells::mark(std::uint64_t cell) {
    const std::atomic_ref<std::uint64_t> word(bits_[cell / 64]);
    const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
    if ((word.load(std::memory_order_relaxed) & bit) == 0) {
        word.fetch_or(bit, std::memory_order_relaxed);
    }
}

}  // namespace hewer::rsimp
