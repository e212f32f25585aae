// SPDX-License-Identifier: MIT
/// One block of the clustered model in memory.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cluster/cell_blocks.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

struct CellBlock {
    static constexpr std::uint32_t kOutside = 0xffffffffU;

    /// Cells of the block; ids are places in the block, and `mean` is in the block's frame. The
    /// refiner permutes them; codes and attributes stay in the order of the ids.
    std::vector<cluster::CellRecord> cells;
    std::vector<std::uint64_t> codes;
    std::vector<cluster::CellAttributes> attributes;  ///< empty if the input has none
    /// Faces with at least two corners in the block, by ids; kOutside for the third.
    std::vector<std::array<std::uint32_t, 3>> faces;
    Vec3
        origin{};  ///< of the block's frame: the centre of a cell, in cells from the lattice origin

    [[nodiscard]] static std::uint64_t bytes_for(std::uint64_t n_cells, std::uint64_t n_faces,
                                                 bool with_attributes) {
        return n_cells * (sizeof(cluster::CellRecord) + sizeof(std::uint64_t) +
                          (with_attributes ? sizeof(cluster::CellAttributes) : 0)) +
               n_faces * 2 * sizeof(cluster::CellTriple);
    }
};

/// Reads block `b`. A cell with a face in the block gets the flag kHasFace.
CellBlock load_block(const cluster::CellBlocks& blocks, std::size_t b);

/// Sums over some cells of the block, in the order of their ids: the same for every way in which
/// they were found. `ids` is sorted.
ClusterSums sum_cells(const CellBlock& block, const std::vector<std::uint32_t>& place_of_id,
                      std::vector<std::uint32_t>& ids);

}  // namespace hewer::rsimp
