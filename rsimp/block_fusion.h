// SPDX-License-Identifier: MIT
/// The uniform method: a grid finer than the edge collapse is to begin with, fused where it
/// costs least.
#pragma once

#include <cstdint>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// Makes at most `n_clusters` clusters out of the cells, by fusing all cells of an octree box into
/// one as long as that adds the least quadric error for each vertex it saves. Boxes of up to
/// 2^kFusionLevels cells a side, none larger than a block; if all of them are too few, all are
/// fused. With n_clusters >= cells nothing is fused: plain OoCS (Lindstrom 2000).
///
/// Unlike refinement it neither follows the surface's directions nor separates components.
///
/// Sweeps: one over the cells for the keys of the boxes, four over the boxes (on a spool, 16 bytes
/// each, about one for two cells) for the choice, then those of build_cluster_mesh(). Memory: for
/// each block in flight 104 bytes a cell.
ClusterMesh fuse_blocks(ooc::Context& context, const cluster::CellBlocks& blocks,
                        std::uint64_t n_clusters);

inline constexpr unsigned kFusionLevels = 3;

}  // namespace hewer::rsimp
