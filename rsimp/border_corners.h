// SPDX-License-Identifier: MIT
/// What the border sums of a cell cannot tell: where a border turns.
#pragma once

#include "cluster/cell_blocks.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// Enough to hold corners; all would hold every tooth of a ragged border, at the cost of the
/// surface (docs/fit.md).
inline constexpr double kHeldShare = 1.0 / 16;

/// Adds to the quadric of each border cell what holds its vertex along the border.
///
/// Without connectivity a vertex has the chord between its two border neighbours, and is held to
/// the line along it (cluster/make_record.h). At the corner of a coarse border that is a diagonal:
/// two corners of a rectangle may meet where their diagonals do, half the rectangle's width outside
/// of it, at no cost. With the edges d and e that meet at the vertex, each the axis of a line
/// quadric with half the weight of its squared length, the chord's quadric lacks h^2 along the
/// chord, h being the height of the triangle that they span with it; nothing where the border goes
/// straight on. Where a border is sampled densely neighbouring chords see the turn, so this is for
/// CellBlocks::has_vertex_cells.
///
/// kHeldShare of that is added.
///
/// Cells where more or less than one border edge arrives and one leaves (sheets that touch, and
/// cells at the wall of a block with a triangle that has no other corner in it) stay as they are.
/// Nothing happens if borders have no weight, or windings disagree.
///
/// One sweep over the cells and faces. Memory: for each block in flight 164 bytes a cell and 84 a
/// triangle.
void hold_border_corners(ooc::Context& context, double border_weight, cluster::CellBlocks& blocks);

}  // namespace hewer::rsimp
