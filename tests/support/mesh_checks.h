// SPDX-License-Identifier: MIT
/// What a reader of a mesh can count about it, without any of the library's own algorithms.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "hewer/mesh_source.h"

namespace hewer::test {

struct Counts {
    std::uint64_t edges = 0;
    std::uint64_t border_edges = 0;          ///< one face
    std::uint64_t nonmanifold_edges = 0;     ///< more than two faces
    std::uint64_t unlike_edges = 0;          ///< two faces that run along it the same way
    std::uint64_t degenerate = 0;            ///< repeated corners
    std::uint64_t duplicates = 0;            ///< faces whose corners, as a set, came before
    std::uint64_t unreferenced = 0;          ///< vertices without a face
    std::uint64_t split_fans = 0;            ///< vertices whose faces are not one fan
    std::uint64_t nonmanifold_vertices = 0;  ///< these, and ends of non-manifold edges
    std::uint64_t border_loops = 0;          ///< those that share a vertex are one
    std::int64_t euler = 0;                  ///< of what is referenced

    [[nodiscard]] bool is_closed() const { return border_edges == 0 && nonmanifold_edges == 0; }
    /// Every edge has one or two faces, every vertex one fan, and nothing is superfluous.
    [[nodiscard]] bool is_clean() const {
        return nonmanifold_edges + degenerate + duplicates + unreferenced + split_fans == 0;
    }
};

Counts count(std::span<const Triangle> triangles, std::uint64_t n_vertices);
inline Counts count(const Mesh& mesh) {
    return count(mesh.triangles, mesh.positions.size());
}

/// Triangles with their lowest corner first: a set that does not depend on order or first corners.
std::set<Triangle> triangle_set(std::span<const Triangle> triangles);

/// Twice the area, as a vector.
Vec3 cross_of(const Mesh& mesh, const Triangle& t);
double area(const Mesh& mesh);
/// Area-weighted squared distance from x to the planes of all triangles.
double plane_error(const Mesh& mesh, const Vec3& x);
Bounds bounds_of(const Mesh& mesh);

}  // namespace hewer::test
