// SPDX-License-Identifier: MIT
/// Joins connected parts that are close to each other, before triangles are spent on them.
#pragma once

#include "cluster/cell_blocks.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// The cells with those of different parts (rsimp/cell_parts.h) that are nearer to each other than
/// options.aggregate merged; `cells` as they are where that is not set. Every cell with a face goes
/// together with the nearest cell of any other part, if the means of both are that near, and of
/// further parts if they are no more than twice as far; cells that
/// hang together by this become one, at the one that is nearest to the middle of them, with the sum
/// of their quadrics and attributes. So both sides of a gap lie on the same cells afterwards: their
/// borders are one seam, and walls that face each other cancel when the mesh is made manifold
/// (rsimp/manifold.h). What is left is clustered, refined and collapsed as one surface.
///
/// Like the vertex pairs of Garland & Heckbert (1997) and of GAPS (Erikson & Manocha 1999), but all
/// pairs within the distance are contracted at once and before anything else, which needs no queue
/// over pairs and works in blocks; and between different parts alone, so that no handle of one part
/// closes. Distances are those between means of cells: where triangles are much larger than the
/// distance, surfaces may be nearer than any of their cells.
///
/// Close cells are found in tiles (rsimp/part_contacts.h): memory for each tile in work 160 bytes a
/// cell, besides CellParts, 8 bytes a cell and 24 a box. Sweeps: those of CellParts, one over the
/// cells, one over those of such boxes, one over everything to copy it. `most_cells` is that of the
/// blocks, before and after. Fills report.aggregate. Neither threads nor memory show. Throws
/// OutOfMemoryBudget (also where the distance holds more cells than memory has room for),
/// OutOfDiskBudget, Cancelled.
cluster::CellBlocks aggregate_parts(ooc::Context& context, cluster::CellBlocks cells,
                                    const SimplifyOptions& options, SimplifyReport& report,
                                    std::uint64_t most_cells = cluster::CellBlocks::kMostCells);

}  // namespace hewer::rsimp
