// SPDX-License-Identifier: MIT
/// Meshes with known properties for tests: closed, bordered, non-manifold, dirty.
#pragma once

#include <cstdint>

#include "hewer/mesh_source.h"

namespace hewer::test {

/// Uniform numbers that are the same with every standard library (SplitMix64).
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next();
    /// In [0, 1).
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    /// In 0 .. n - 1; 0 for n == 0.
    std::uint64_t below(std::uint64_t n) { return n == 0 ? 0 : next() % n; }

  private:
    std::uint64_t state_;
};

/// The box [-1, 1]^3, n x n squares a side, corners and edges shared: 12 n^2 triangles.
Mesh cube(std::uint64_t n);
/// cube() pushed out to the sphere of radius 1; radii vary by +-`noise`.
Mesh cube_sphere(std::uint64_t n, double noise = 0, std::uint64_t seed = 1);
/// Genus 1 around the z axis, radii 1 and `thickness`: 2 * n_major * n_minor triangles.
Mesh torus(std::uint64_t n_major, std::uint64_t n_minor, double thickness = 0.4);
/// [0, 1]^2, n x n squares, heights in +-`noise` but at the border, which stays at 0.
Mesh plane_grid(std::uint64_t n, double noise = 0, std::uint64_t seed = 1);
/// Two plane_grid(n), `gap` apart, wound away from each other; not connected.
Mesh two_sheets(std::uint64_t n, double gap);
/// k^3 spheres of radius 0.4 with their centres on the integer grid.
Mesh many_spheres(std::uint64_t k, std::uint64_t n);
/// Pages of n x n squares that share one spine.
Mesh book(std::uint64_t n_pages, std::uint64_t n);
/// A strip with a half turn: not orientable.
Mesh moebius_strip(std::uint64_t n_around, std::uint64_t n_across);
/// Any three of n_vertices random points, again and again.
Mesh random_soup(std::uint64_t n_vertices, std::uint64_t n_triangles, std::uint64_t seed);

/// The same surface with vertices, triangles and the first corner of each triangle in random order.
Mesh shuffled(const Mesh& mesh, std::uint64_t seed);
/// Turns `share` of the triangles over.
Mesh with_turned_triangles(Mesh mesh, double share, std::uint64_t seed);
Mesh translated(Mesh mesh, const Vec3& by);
Mesh scaled(Mesh mesh, const Vec3& by);
/// Both meshes in one; attributes only if both have them.
Mesh joined(Mesh a, const Mesh& b);
/// Rounds coordinates to multiples of 2^-20, so that moving by whole numbers is exact.
Mesh rounded(Mesh mesh);
/// Colours that are a linear function of the position: color_at(position).
Mesh with_colors(Mesh mesh);
Rgba16 color_at(const Vec3& position);
/// Unit normals away from the origin.
Mesh with_radial_normals(Mesh mesh);

}  // namespace hewer::test
