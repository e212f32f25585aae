// SPDX-License-Identifier: MIT
/// From the input to the mesh that the finishing collapse begins with: clustering, refinement, and
/// as many repetitions of either as the target needs.
#pragma once

#include "cluster/cell_store.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/clusters.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/manifold.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

struct StartMesh {
    Clusters clusters;
    ManifoldMesh manifold;
};

/// How many clusters the target needs is known only from the mesh that they make: two triangles
/// come of each on a closed surface, next to none where thin parts or many small components vanish
/// in their clusters. So clusters are added until the collapse has enough triangles to choose from;
/// if all cells are too few, the input is clustered again on a finer grid. With an error bound the
/// same is done as long as a part of the surface has vanished.
///
/// `store` receives the cell store; its cells may have been permuted.
StartMesh make_start_mesh(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
                          StageLog& stages, cluster::CellStore& store, SimplifyReport& report);

/// Gives every vertex of `manifold` the place and the quadric of its cluster; takes the triangles
/// out of it. Vertices that share a cluster share its quadric, and step apart towards their own
/// neighbours.
CollapseMesh make_collapse_mesh(ooc::Context& context, const Clusters& clusters,
                                ManifoldMesh& manifold);

}  // namespace hewer::rsimp
