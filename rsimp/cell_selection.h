// SPDX-License-Identifier: MIT
/// Some cells of a model as a model of their own.
#pragma once

#include <cstdint>
#include <functional>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/ranked_set.h"

namespace hewer::rsimp {

/// May change what a cell that stays stands for; `attributes` is null where there are none. Cells
/// come by rising id.
using ChangeCell = std::function<void(std::uint64_t cell, cluster::CellRecord& record,
                                      cluster::CellAttributes* attributes)>;

/// Appends the cells that stay to `to`, which is empty, and cuts its blocks; faces are the
/// caller's. `from` loses its cells on the way, its codes stay. `change` may be empty.
void copy_cells(ooc::Context& context, cluster::CellBlocks& from, const ooc::RankedSet& kept,
                const ChangeCell& change, std::uint64_t most_cells, cluster::CellBlocks& to);

/// The borders of the cells that are kept, under their new ids.
void copy_borders(const cluster::CellBlocks& from, const ooc::RankedSet& kept,
                  cluster::CellBlocks& to);

}  // namespace hewer::rsimp
