// SPDX-License-Identifier: MIT
/// Attribute quadrics of the cells, from their colours and normals and the triangles between them.
#pragma once

#include "cluster/cell_blocks.h"
#include "ooc/context.h"

namespace hewer::rsimp {

/// What a difference of attributes counts as, in cells; 0: nothing.
struct AttributeScales {
    double color = 0;   ///< of a colour channel, from none to all
    double normal = 0;  ///< of a component of a unit normal, by one

    [[nodiscard]] bool any() const { return color > 0 || normal > 0; }
};

/// Fills CellBlocks::attribute_quadrics. On each triangle between three cells, whose corners are
/// the cells' means, attributes are linear; a cell has the mean over the triangles at it, weighted
/// with their areas, times the area of the surface that the cell stands for: so where a user gives
/// weights to cells, they count here, too.
///
/// Differs from Hoppe (1999), who takes the triangles of the input: what varies within a cell is
/// noise to an output that is coarser by far, and its slopes would be steep. A needle between three
/// cells has none to speak of either.
///
/// One sweep over the blocks; triangles are taken in a sorted order, so that sums have equal bits
/// always. A cell at the wall of a block does not see those of its triangles of which no other
/// corner is in its block. Memory: for each block in flight 450 bytes a cell and 12 a triangle; 140
/// bytes a cell on a spool. Precondition: blocks.attributes is there.
void fit_attributes(ooc::Context& context, const AttributeScales& scales,
                    cluster::CellBlocks& blocks);

}  // namespace hewer::rsimp
