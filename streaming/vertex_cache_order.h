// SPDX-License-Identifier: MIT
/// The order in which triangles and vertices go out: the one that a graphics card draws fastest.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace hewer::streaming {

/// `new_index_of_vertex` of a vertex that no triangle uses.
constexpr std::uint32_t kUnusedVertex = ~0U;

/// Reorders the triangles so that each vertex is transformed about once by a card that remembers
/// the last few (the post-transform cache), and numbers the vertices by their first use in that
/// order, so that they are fetched from memory front to back. Triangles keep their corners and
/// their winding; which corner comes first may change. Deterministic.
///
/// @param triangles            corner ids below n_vertices; reordered and renumbered in place.
/// @param new_index_of_vertex  n_vertices long; receives the place of each vertex, 0, 1, 2, ...
///                             over the used ones, kUnusedVertex for the others.
/// Memory: vertex_cache_order_bytes(), not reserved here but by the caller.
/// Throws InternalError if the sizes do not match or a corner is out of range.
/// Algorithm: Sander, Nehab and Barczak 2007 ("tipsify") for a first-in-first-out cache of 16;
/// code: meshoptimizer's. Its slower scoring variant was measured and left: on a scan of 200 k
/// triangles it takes four times as long (51 against 13 ms) to transform .66 instead of .70
/// vertices a triangle.
void order_for_vertex_cache(std::span<std::array<std::uint32_t, 3>> triangles,
                            std::uint64_t n_vertices, std::span<std::uint32_t> new_index_of_vertex);

/// Most bytes that order_for_vertex_cache() holds besides its arguments: for each triangle a copy,
/// its place in the lists around its corners, the stack of recent corners, a flag; for each vertex
/// length and start of its list, triangles left, time of its last use.
constexpr std::uint64_t vertex_cache_order_bytes(std::uint64_t n_triangles,
                                                 std::uint64_t n_vertices) {
    return n_triangles * (12 + 12 + 12 + 1) + n_vertices * (4 + 4 + 4 + 4);
}

}  // namespace hewer::streaming
