// SPDX-License-Identifier: MIT
/// Necks that are thinner than a cluster: what hung on one stays where it hung.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rsimp/block_mesh.h"

namespace hewer::rsimp {

/// Joins components that were connected before clusters were made of the vertices of the input:
/// those that share a cluster of several vertices, those at two clusters with a link, and those
/// that are linked by way of clusters without a face. A tube does it, a connected sum: a triangle
/// (v, a, b) of one component and (w, c, d) of the other go, six around the gap take their place.
/// Of the tubes that would join two components the shortest is built; as none joins a component
/// with itself, handles that were cut stay cut. At most one tube is built for each 400 faces: a
/// surface with more necks is noise, and others have more use for its triangles.
///
/// `mesh`: the clusters. `named`: faces whose corners are vertices of `mesh` or, n + k, the k-th
/// further fan of a cluster, which is extra[k]. `links`: pairs of clusters between which an edge of
/// the input runs, as (A, B, B).
///
/// Not where two fans meet in a cluster of one vertex: the input is pinched itself there. Nor if
/// both components reach into another block: they may hang together there.
///
/// Returns the number of joins, each of which adds four faces. The order of faces and links shows
/// in the order of the result only. Memory: 24 bytes a vertex, and 12 a face near a neck.
std::uint64_t join_necks(const BlockMesh& mesh, std::span<const std::uint32_t> extra,
                         std::span<const LocalFace> links, std::vector<LocalFace>& named);

}  // namespace hewer::rsimp
