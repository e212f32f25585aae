// SPDX-License-Identifier: MIT
/// Removes small parts of the model before triangles are spent on them.
#pragma once

#include <cstdint>

#include "cluster/cell_blocks.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// The cells without the connected parts (rsimp/cell_parts.h) whose box has a diagonal below
/// options.drop_parts, and without the triangles of these; `cells` as they are where that is not
/// set or nothing is that small. A part's box is that around the means of its cells: on each axis
/// at most a cell shorter than the part. Parts that have no triangle between cells are not looked
/// at; the grid loses them anyway (rsimp/lost_parts.h). Fills report.dropped. `most_cells` is that
/// of the blocks of `cells`, and of those that come out.
///
/// Sweeps: those of CellParts, one over the cells for the boxes, one over everything to copy what
/// stays. Memory: 68 bytes a piece of CellParts, 3/16 of a byte a cell, and what CellParts and
/// BlockCutter take.
/// Throws InvalidArgument if no part is large enough, OutOfMemoryBudget, OutOfDiskBudget,
/// Cancelled.
cluster::CellBlocks drop_parts(ooc::Context& context, cluster::CellBlocks cells,
                               const SimplifyOptions& options, SimplifyReport& report,
                               std::uint64_t most_cells = cluster::CellBlocks::kMostCells);

}  // namespace hewer::rsimp
