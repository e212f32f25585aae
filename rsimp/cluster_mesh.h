// SPDX-License-Identifier: MIT
/// What refinement (or fusion, or the bare cells) comes to: clusters of cells as vertices, and the
/// triangles whose corners are in three different clusters.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cluster/cell_blocks.h"
#include "cluster/quadric.h"
#include "ooc/spool.h"
#include "rsimp/vertex_attributes.h"

namespace hewer::rsimp {

using cluster::CellTriple;

/// A vertex and what it stands for; two cache lines. Lengths in cells.
struct CollapseVertex {
    Vec3 position;
    cluster::Quadric quadric;  ///< all relative to one origin
    std::array<float, 6> box;  ///< low and high of the cells that it stands for
};
static_assert(sizeof(CollapseVertex) == 128);

/// Makes a box reach as far as another one, too.
inline void widen(std::array<float, 6>& box, const std::array<float, 6>& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        box[k] = std::min(box[k], other[k]);
        box[3 + k] = std::max(box[3 + k], other[3 + k]);
    }
}

/// Clusters have the order of the blocks that they come from; ids are places in that order.
struct ClusterMesh {
    struct Block {
        cluster::OctreeBox box;
        std::uint64_t first_cluster = 0;
        std::uint64_t first_face = 0;
        std::uint64_t first_link = 0;
    };

    using Link = std::array<std::uint32_t, 2>;

    Vec3 origin{};  ///< of all coordinates here, in cells from the lattice origin
    ooc::Spool<CollapseVertex> vertices;  ///< by cluster id
    ooc::Spool<std::uint32_t> n_cells;    ///< by cluster id
    AttributeSpools attributes;           ///< by cluster id
    /// Cluster ids, three different ones. Each face is once in the list of a block that has at
    /// least one of its corners; duplicates and opposite pairs are still there.
    ooc::Spool<CellTriple> faces;
    /// Clusters, smaller id first, with an edge of the input between them; many have a face as
    /// well. Empty unless has_links.
    ooc::Spool<Link> links;
    ooc::Spool<std::uint32_t> cluster_of_cell;  ///< cluster ids by cell id
    std::vector<Block> blocks;                  ///< and one more at the end, with the totals
    /// No cell has a border: equally wound copies of a face belong to different sheets, then.
    bool is_closed = false;
    /// Clusters are connected sets of vertices of a closed input, some of several vertices.
    bool has_links = false;

    [[nodiscard]] std::uint64_t n_clusters() const { return vertices.size(); }
    [[nodiscard]] std::size_t n_blocks() const { return blocks.empty() ? 0 : blocks.size() - 1; }
};

}  // namespace hewer::rsimp
