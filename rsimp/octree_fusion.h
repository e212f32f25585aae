// SPDX-License-Identifier: MIT
/// The uniform method's last step: a grid twice as fine as the target asks for, fused where it
/// costs least.
#pragma once

#include <cstdint>

#include "cluster/cell_store.h"
#include "ooc/context.h"
#include "rsimp/refiner.h"

namespace hewer::rsimp {

/// Makes at most `n_clusters` clusters out of the cells, by fusing all cells of an octree box into
/// one as long as that adds the least quadric error for each vertex it saves. Boxes of up to
/// 2^kLevels cells a side; Morton order keeps their cells together, so this takes one pass over the
/// cells for each level. With n_clusters >= cells nothing is fused: plain OoCS (Lindstrom 2000).
///
/// Unlike refinement it neither follows the surface's directions nor separates components.
/// Memory: 16 bytes a cell beside the clusters.
Clusters fuse_cells(ooc::Context& context, const cluster::CellStore& store,
                    std::uint64_t n_clusters);

}  // namespace hewer::rsimp
