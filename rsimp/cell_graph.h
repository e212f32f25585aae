// SPDX-License-Identifier: MIT
/// Which cells of a block hang together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cluster/cell_blocks.h"
#include "rsimp/block_cut.h"

namespace hewer::rsimp {

/// The graph of a block's cells: two are neighbours if a face in the list of the block has a corner
/// in either. Clusters are split by its components; unlike faces it needs no partition.
///
/// One object serves many blocks, one after the other. Memory: bytes_for() the largest of them.
class CellGraph {
  public:
    static constexpr std::uint64_t bytes_for(std::uint64_t n_cells, std::uint64_t n_faces) {
        return n_cells *
                   (2 * sizeof(std::uint32_t) + sizeof(LocalCell) + 2 * sizeof(std::uint8_t)) +
               3 * n_faces * (sizeof(Edge) + sizeof(LocalCell));
    }

    /// One pass over the faces of the block.
    void load(const cluster::CellBlocks& blocks, std::size_t block);

    /// The neighbours of `cell` that come after it in the block, rising.
    [[nodiscard]] std::span<const LocalCell> later_neighbours(LocalCell cell) const {
        return {neighbours_.data() + begin_[cell], neighbours_.data() + end_[cell]};
    }
    /// A face in the list of the block has a corner in `cell`.
    [[nodiscard]] bool has_face(LocalCell cell) const { return has_face_[cell] != 0; }

    /// All neighbours of `cell` in the block.
    [[nodiscard]] std::uint32_t degree(LocalCell cell) const { return degree_[cell]; }
    /// A face in the list of the block joins `cell` to a cell of another block.
    [[nodiscard]] bool leaves_block(LocalCell cell) const { return leaves_block_[cell] != 0; }

  private:
    struct Edge {
        LocalCell from;
        LocalCell to;
    };
    void add_edges_of(const cluster::CellTriple& face, std::uint64_t first_cell,
                      std::uint64_t last_cell);

    std::vector<Edge> edges_;  // scratch: with copies, in the order of the faces
    std::vector<LocalCell> neighbours_;
    std::vector<std::uint32_t> begin_;  // by cell, into neighbours_
    std::vector<std::uint32_t> end_;
    std::vector<LocalCell> degree_;
    std::vector<std::uint8_t> has_face_;
    std::vector<std::uint8_t> leaves_block_;
};

}  // namespace hewer::rsimp
