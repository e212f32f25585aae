// SPDX-License-Identifier: MIT
/// A mesh as a MeshStore with any ids.
#pragma once

#include <cstdint>
#include <vector>

#include "ooc/context.h"
#include "rsimp/mesh_store.h"
#include "tests/support/mesh_checks.h"

namespace hewer::test {

/// Frame of the store: coordinates in it are those of the mesh minus this.
inline constexpr Vec3 kStoreOrigin{3, -2, 0.5};

/// n different ids in random order; every third cluster has several fans, some of them no first
/// one.
std::vector<rsimp::VertexId> random_ids(std::uint64_t n, std::uint64_t seed);

/// Vertex v of `mesh` gets ids[v]. Boxes are the unit cubes around the vertices, a little off.
/// With normals or colours, attributes: a normal twice as long, three times the colour.
rsimp::MeshStore store_mesh(ooc::Context& context, const Mesh& mesh,
                            const std::vector<rsimp::VertexId>& ids);

/// `mesh` with its vertices in the order of `ids`, as it should come out.
Mesh sorted_by_id(const Mesh& mesh, const std::vector<rsimp::VertexId>& ids);

/// By flooding.
std::uint64_t count_components(const Mesh& mesh);

}  // namespace hewer::test
