// SPDX-License-Identifier: MIT
/// Clusters of cells as vertices: what a cut of the tree, a fusion, or the bare cells come to.
#pragma once

#include <array>
#include <cstdint>

#include "cluster/cell_store.h"
#include "cluster/quadric.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

/// One vertex for each cluster. Lengths in cells.
struct Clusters {
    ooc::Array<std::uint32_t> cluster_of_cell;  ///< by cell id
    ooc::Array<Vec3> positions;                 ///< relative to `origin`
    ooc::Array<cluster::Quadric> quadrics;      ///< relative to `origin`
    ooc::Array<std::array<float, 6>> boxes;     ///< low and high of the cells, relative to `origin`
    ooc::Array<cluster::CellAttributes> attributes;  ///< summed; empty if there are none
    Vec3 origin{};                                   ///< in cells from the lattice origin

    std::uint64_t n_clusters = 0;

    [[nodiscard]] std::uint64_t size() const { return n_clusters; }
};

/// Room for `n` clusters over the cells of `store`. Memory: 128 bytes a cluster, 4 a cell.
Clusters make_clusters(ooc::Context& context, const cluster::CellStore& store, std::uint64_t n);

/// Writes cluster `k` from its sums; `shift` takes the sums' frame to the clusters' origin.
void store_cluster(Clusters& clusters, std::uint64_t k, const ClusterSums& sums, const Vec3& shift);

/// Every cell a cluster of its own, without a tree.
Clusters clusters_from_cells(ooc::Context& context, const cluster::CellStore& store);

}  // namespace hewer::rsimp
