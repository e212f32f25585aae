// SPDX-License-Identifier: MIT
/// Where the surface in a cell is.
#pragma once

#include "cluster/cell_blocks.h"

namespace hewer::rsimp {

/// The mean of a cell, in cells from the lattice origin.
inline Vec3 mean_of(std::uint64_t code, const cluster::CellRecord& record) {
    const auto beyond = record.mean_beyond();
    Vec3 mean = cluster::center_of(code);
    for (std::size_t k = 0; k < 3; ++k) mean[k] += static_cast<double>(record.mean[k]) + beyond[k];
    return mean;
}

}  // namespace hewer::rsimp
