// SPDX-License-Identifier: MIT
/// What of the original borders the fit of a level of detail sees.
#pragma once

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/fit_samples.h"

namespace hewer::rsimp {

/// One for each cell with a border: the point of its border line next to the mean of its surface,
/// with the length of the chord as area and the direction of the border, the surface on the left,
/// as normal. In Morton order. None if the input is not wound consistently. One pass over the
/// lines.
ooc::Spool<FitSample> collect_border_samples(ooc::Context& context,
                                             const cluster::CellBlocks& cells);

}  // namespace hewer::rsimp
