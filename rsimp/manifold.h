// SPDX-License-Identifier: MIT
/// From triples of clusters to a manifold triangle mesh: duplicates settled, sheets that merely
/// touch taken apart.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "cluster/accumulate.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::rsimp {

using cluster::CellTriple;

inline constexpr std::uint32_t kNoIndex = 0xffffffffU;

/// A triangle mesh in which every edge has one or two faces and the faces around every vertex form
/// one fan.
struct ManifoldMesh {
    ooc::Array<CellTriple> triangles;             ///< vertex ids; no repeated, no duplicate face
    ooc::Array<std::uint32_t> cluster_of_vertex;  ///< several vertices may share a cluster
    std::uint64_t n_cancelled = 0;  ///< faces dropped: opposites and, where not closed, duplicates
    std::uint64_t n_bubble_faces = 0;  ///< faces of bubbles that folding had pinched off
    std::uint64_t n_cut_vertices = 0;  ///< clusters that became more than one vertex
};

/// Merging vertices of a surface folds parts of it onto each other. As integer chains (each face
/// with its winding as sign) the boundary of a closed surface stays zero under merging, so:
///  - copies of a face cancel against its opposites; this opens nothing. As many of each: one pair
///  stays,
///    as a sheet folded onto itself, so that thin parts do not vanish. Equally wound copies that
///    are left over all stay if `is_closed` (each is part of some closed sheet), else only one: the
///    rest is dirt;
///  - an edge with more than two faces is where sheets touch: its faces are paired, forward with
///    backward, the flattest pairs first, and a vertex is made for every fan of faces that is then
///    left around a cluster. So no edge is opened and no edge keeps more than two faces;
///  - small closed components that share a cluster with a larger one are dropped.
///
/// `triples` are cluster ids; those with repeated ids are skipped. `positions` (by cluster) decide
/// which pairs are flat. Equal input sets give equal output, whatever their order. Memory: 60 bytes
/// a triangle on the way.
ManifoldMesh build_manifold(ooc::Context& context, std::span<const CellTriple> triples,
                            std::span<const Vec3> positions, bool is_closed);

/// Edge counts of any indexed mesh.
struct EdgeCounts {
    std::uint64_t edges = 0;
    std::uint64_t border = 0;
    std::uint64_t nonmanifold = 0;
};
EdgeCounts count_edges(ooc::Context& context, std::span<const CellTriple> triangles,
                       std::uint64_t n_vertices);

}  // namespace hewer::rsimp
