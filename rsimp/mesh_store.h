// SPDX-License-Identifier: MIT
/// A finished mesh of any size: sorted vertices, sorted faces. Between the finishing collapse, the
/// writers and the next level of detail.
#pragma once

#include <array>
#include <cstdint>

#include "ooc/spool.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/vertex_attributes.h"

namespace hewer::rsimp {

/// Cluster that the vertex came from, and its number among the fans of faces around that cluster:
/// so ids rise along the Morton curve, and a vertex keeps its id for life.
using VertexId = std::uint64_t;
inline constexpr unsigned kFanBits = 24;
constexpr VertexId vertex_id(std::uint64_t cluster, std::uint64_t fan) {
    return cluster << kFanBits | fan;
}
constexpr std::uint64_t cluster_of(VertexId id) {
    return id >> kFanBits;
}

struct StoredVertex {
    VertexId id;
    CollapseVertex vertex;
    std::uint32_t n_cells;  ///< of the grid, that it stands for
    std::uint32_t flags;
};
static_assert(sizeof(StoredVertex) == 144);

/// Corner ids, rotated so that the smallest comes first.
using Face = std::array<VertexId, 3>;

struct MeshStore {
    Vec3 origin{};  ///< of all coordinates here, in cells from the lattice origin
    ooc::Spool<StoredVertex> vertices;  ///< rising ids; each is used by a face
    AttributeSpools attributes;
    ooc::Spool<Face> faces;  ///< rising, lexicographically
};

}  // namespace hewer::rsimp
