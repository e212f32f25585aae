// SPDX-License-Identifier: MIT
/// What refinement (or fusion, or the bare cells) comes to: clusters of cells as vertices, and the
/// triangles whose corners are in three different clusters.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "cluster/cell_blocks.h"
#include "cluster/quadric.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

using cluster::CellTriple;

/// A vertex and what it stands for; two cache lines. Lengths in cells.
struct CollapseVertex {
    Vec3 position;
    cluster::Quadric quadric;  ///< all relative to one origin
    std::array<float, 6> box;  ///< low and high of the cells that it stands for
};
static_assert(sizeof(CollapseVertex) == 128);

/// Clusters have the order of the blocks that they come from; ids are places in that order.
struct ClusterMesh {
    struct Block {
        cluster::OctreeBox box;
        std::uint64_t first_cluster = 0;
        std::uint64_t first_face = 0;
    };

    Vec3 origin{};  ///< of all coordinates here, in cells from the lattice origin
    ooc::Spool<CollapseVertex> vertices;             ///< by cluster id
    ooc::Spool<std::uint32_t> n_cells;               ///< by cluster id
    ooc::Spool<cluster::CellAttributes> attributes;  ///< by cluster id; empty if there are none
    /// Cluster ids, three different ones. Each face is once in the list of a block that has at
    /// least one of its corners; duplicates and opposite pairs are still there.
    ooc::Spool<CellTriple> faces;
    std::vector<Block> blocks;  ///< and one more at the end, with the totals
    /// No cell has a border: equally wound copies of a face belong to different sheets, then.
    bool is_closed = false;

    [[nodiscard]] std::uint64_t n_clusters() const { return vertices.size(); }
    [[nodiscard]] std::size_t n_blocks() const { return blocks.empty() ? 0 : blocks.size() - 1; }
};

struct ClusterSums;

/// What the cells of one block come to.
struct BlockClusters {
    std::vector<CollapseVertex> vertices;
    std::vector<std::uint32_t> n_cells;
    std::vector<cluster::CellAttributes> attributes;  ///< empty if there are none
    std::vector<std::uint32_t> cluster_of_cell;  ///< places in `vertices`, by cell of the block

    /// Appends a cluster of `n` cells; `shift` takes the frame of the sums to the origin of the
    /// mesh.
    void add(const ClusterSums& sums, const Vec3& shift, std::uint32_t n);
};

/// Origin of the mesh's coordinates, in cells from the lattice origin.
Vec3 cluster_origin(const cluster::CellBlocks& cells);

/// Collects the clusters that make(block) comes to, and maps the faces. make() runs on all threads,
/// for at most `most_alive` blocks at once. Two sweeps over the blocks; the second reads 12 bytes a
/// face and 4 a cell.
ClusterMesh build_cluster_mesh(ooc::Context& context, const cluster::CellBlocks& cells,
                               std::size_t most_alive,
                               const std::function<BlockClusters(std::size_t)>& make);

}  // namespace hewer::rsimp
