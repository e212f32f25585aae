// SPDX-License-Identifier: MIT
/// Triangles whose vertices are all over a file that memory does not hold: an external join.
#pragma once

#include <cstdint>

#include "cluster/lattice.h"
#include "cluster/triangle_partition.h"
#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::cluster {

/// The triangles of the source, by streaming::CornerJoin: two passes over the triangles and one
/// over the vertices, 12 bytes a vertex for those of a range, `range_bytes` in all.
///
/// @param spooled  the vertices, if the source cannot seek.
PartitionFindings join_vertices(ooc::Context& context, MeshSource& source,
                                const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                                std::uint64_t range_bytes, TrianglePartition& partition);

}  // namespace hewer::cluster
