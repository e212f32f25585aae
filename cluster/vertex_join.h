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

/// Every corner is a number; numbers are put into buckets by range of vertices, in the order of the
/// corners. Range by range, with its vertices in memory, a bucket's numbers become points in the
/// same order. A second pass over the triangles takes the points of its corners from the buckets,
/// each of which is read front to back: so nothing is sorted and no place is stored.
///
/// Two passes over the triangles and one over the vertices. Disk: 4 bytes a corner, then 12;
/// memory: 12 bytes a vertex of a range, `range_bytes` in all, and a page for each range.
///
/// @param spooled  the vertices, if the source cannot seek.
PartitionFindings join_vertices(ooc::Context& context, MeshSource& source,
                                const ooc::Spool<LatticePoint>& spooled, const Lattice& lattice,
                                std::uint64_t range_bytes, TrianglePartition& partition);

}  // namespace hewer::cluster
