// SPDX-License-Identifier: MIT
/// The uniform method's last step: a grid finer than the target asks for, fused where it costs
/// least.
#pragma once

#include <cstdint>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// Makes at most `n_clusters` clusters out of the cells, by fusing all cells of an octree box into
/// one as long as that adds the least quadric error for each vertex it saves. Boxes of up to
/// 2^kLevels cells a side, inside the blocks. With n_clusters >= cells nothing is fused: plain OoCS
/// (Lindstrom 2000).
///
/// Unlike refinement it neither follows the surface's directions nor separates components.
/// Memory: for each block at work its cells and 32 bytes a cell; boxes wait on a spool.
ClusterMesh fuse_blocks(ooc::Context& context, const cluster::CellBlocks& cells,
                        std::uint64_t n_clusters);

}  // namespace hewer::rsimp
