// SPDX-License-Identifier: MIT
/// From groups of cells to clusters with vertices, and faces between them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/block_cut.h"
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// The cells of a block, cluster by cluster.
struct CellGroups {
    std::vector<LocalCell> order;  ///< empty: in the order of the block
    /// Places in that order at which the clusters begin; the first is 0.
    std::vector<LocalCell> begins;
};

/// Fills in the groups of a block. Called by many threads at once, once for each block.
using GroupCells = std::function<void(std::size_t block, CellGroups& groups)>;

/// Every group becomes a cluster: its sums are over its cells in their own order, so it does not
/// matter how the groups were found or in which order they list them; its vertex is the minimum of
/// its quadric. Clusters have the order of the blocks and, inside, of the groups.
///
/// Two sweeps over the blocks: cells to clusters, then faces. A face's corners in other blocks are
/// looked up in a spool of 4 bytes a cell through a small cache. Memory: for each block in flight
/// 350 bytes for each of its cells (420 more with attribute quadrics), or 20 for each of its faces.
ClusterMesh build_cluster_mesh(ooc::Context& context, const cluster::CellBlocks& blocks,
                               const GroupCells& group_cells);

/// Every cell a cluster of its own, without a tree. Cluster ids are cell ids.
ClusterMesh cells_as_clusters(ooc::Context& context, const cluster::CellBlocks& blocks);

}  // namespace hewer::rsimp
