// SPDX-License-Identifier: MIT
#include "rsimp/cell_block.h"

#include <algorithm>

#include "ooc/vec3.h"

namespace hewer::rsimp {

using cluster::CellRecord;
using cluster::CellTriple;

CellBlock load_block(const cluster::CellBlocks& blocks, std::size_t b) {
    const cluster::CellBlocks::Block& first = blocks.blocks[b];
    const cluster::CellBlocks::Block& last = blocks.blocks[b + 1];
    const std::uint64_t n = last.first_cell - first.first_cell;
    CellBlock block;
    block.cells.resize(n);
    block.codes.resize(n);
    blocks.cells.read(first.first_cell, block.cells);
    blocks.codes.read(first.first_cell, block.codes);
    if (!blocks.attributes.empty()) {
        block.attributes.resize(n);
        blocks.attributes.read(first.first_cell, block.attributes);
    }
    block.origin = cluster::center_of(block.codes[n / 2]);
    for (std::uint32_t i = 0; i < n; ++i) {
        CellRecord& cell = block.cells[i];
        cell.id = i;
        cell.flags &= ~CellRecord::kHasFace;
        const Vec3 center = cluster::center_of(block.codes[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            cell.mean[k] =
                static_cast<float>(center[k] - block.origin[k] + static_cast<double>(cell.mean[k]));
        }
    }
    ooc::SpoolReader<CellTriple> faces(blocks.faces, first.first_face, last.first_face);
    while (const CellTriple* face = faces.next()) {
        CellTriple local;
        std::size_t n_inside = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t id = (*face)[i];
            const bool is_inside = id >= first.first_cell && id < last.first_cell;
            local[i] =
                is_inside ? static_cast<std::uint32_t>(id - first.first_cell) : CellBlock::kOutside;
            n_inside += is_inside ? 1U : 0U;
        }
        if (n_inside < 2) continue;
        block.faces.push_back(local);
        for (const std::uint32_t id : local) {
            if (id != CellBlock::kOutside) block.cells[id].flags |= CellRecord::kHasFace;
        }
    }
    return block;
}

ClusterSums sum_cells(const CellBlock& block, const std::vector<std::uint32_t>& place_of_id,
                      std::vector<std::uint32_t>& ids) {
    std::sort(ids.begin(), ids.end());
    ClusterSums sums;
    for (const std::uint32_t id : ids) sums.add(block.cells[place_of_id[id]]);
    return sums;
}

}  // namespace hewer::rsimp
