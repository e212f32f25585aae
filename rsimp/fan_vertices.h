// SPDX-License-Identifier: MIT
/// Vertices for the fans of faces that one cluster turned out to have.
#pragma once

#include <cstdint>
#include <vector>

#include "rsimp/block_mesh.h"

namespace hewer::rsimp {

/// Appends a vertex for each further fan; extra[k] is the vertex that the k-th was cut from, and
/// the faces name it n_vertices + k already. Fans share the cluster's quadric evenly and step
/// apart, towards their own neighbours and, since the two sides of a folded sheet have the same
/// neighbours, along their normals. Further fans of a cluster are numbered 1, 2, ...; with
/// `next_fan` from that on, whatever the cluster. Returns how many vertices were cut.
std::uint64_t add_fan_vertices(BlockMesh& mesh, const std::vector<std::uint32_t>& extra,
                               std::uint64_t* next_fan);

}  // namespace hewer::rsimp
