// SPDX-License-Identifier: MIT
/// Test meshes as blocks and as cluster meshes, with quadrics of their own triangles and borders.
/// Coordinates are taken to be in cells.
#pragma once

#include "ooc/context.h"
#include "rsimp/block_mesh.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/mesh_store.h"
#include "tests/support/mesh_checks.h"

namespace hewer::test {

/// Every vertex a raw cluster with its own number as id, all in one block.
rsimp::BlockMesh raw_block(const Mesh& mesh);

/// The same with free vertices.
rsimp::BlockMesh free_block(const Mesh& mesh);

Mesh to_mesh(const rsimp::BlockMesh& block);
Mesh to_mesh(const rsimp::MeshStore& store);

/// Every vertex a cluster, in Morton order of the unit cells that they are in, in octree boxes of
/// at most `most` vertices. Coordinates must be in [0, 2^20).
rsimp::ClusterMesh cluster_mesh(ooc::Context& context, const Mesh& mesh, std::uint64_t most,
                                bool is_closed);

}  // namespace hewer::test
