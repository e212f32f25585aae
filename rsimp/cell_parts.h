// SPDX-License-Identifier: MIT
/// Which cells of the model hang together: its connected parts, as far as the grid tells them
/// apart.
#pragma once

#include <cstdint>
#include <string_view>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/disjoint_sets.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// Cells are connected if a surviving triangle has corners in both; parts of the surface that share
/// a cell are one part. A cell without a face is a part of its own.
///
/// Every cell is labelled with the piece of its part inside its block, and pieces are joined where
/// a triangle reaches from one block into another. Two sweeps: over the faces, then over those
/// between blocks, a few per cent. Memory: 4 bytes a piece, of which a surface has some for each
/// block (at worst a model of loose triangles has one for each), and for each block in flight 8
/// bytes a cell and 16 a face. Spools: 4 bytes a cell, 8 a face between blocks.
/// Neither threads nor memory show.
class CellParts {
  public:
    CellParts(ooc::Context& context, const cluster::CellBlocks& cells);

    /// Of cells, in their order.
    [[nodiscard]] const ooc::Spool<std::uint32_t>& pieces() const { return pieces_; }
    [[nodiscard]] std::uint64_t n_pieces() const { return sets_.size(); }
    /// The part that a piece belongs to, by its first piece. One thread.
    [[nodiscard]] std::uint64_t part_of(std::uint64_t piece) { return sets_.find(piece); }

  private:
    ooc::Spool<std::uint32_t> pieces_;
    ooc::DisjointSets sets_;
};

}  // namespace hewer::rsimp
