// SPDX-License-Identifier: MIT
/// Weights that a user gives to parts of the surface, by vertex or by place.
#pragma once

#include <span>

#include "cluster/cell_blocks.h"
#include "hewer/options.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// Weights of cells are from this on: what counts for nothing would have no place.
inline constexpr double kLeastCellWeight = 1e-3;
inline constexpr double kMostCellWeight = 1e6;

/// The surface in each cell counts as so many times its area: the mean weight of the cell's
/// vertices, if they have any, times those of all boxes of `focus` that its mean lies in. Quadrics,
/// borders included, areas and normals are multiplied; all that is derived of them, which is the
/// split keys, the costs of collapses, the pull of the samples of the fit, follows. Takes
/// CellBlocks::weights away. A box without any cell gets a warning.
///
/// The sums of weights in the cells are whole numbers (WeightSums), so their means do not depend on
/// the order of the input. One pass over the cells; memory: buffers.
void weigh_cells(ooc::Context& context, std::span<const FocusBox> focus,
                 cluster::CellBlocks& blocks);

}  // namespace hewer::rsimp
