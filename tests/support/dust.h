// SPDX-License-Identifier: MIT
/// A large part and many small ones.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/vec3.h"
#include "tests/support/shapes.h"

namespace hewer::test {

inline double distance(const Vec3& a, const Vec3& b) {
    return std::sqrt(dot(a - b, a - b));
}

/// A sphere of radius 1, and `n` small ones on a ring around it, with radii from `least` to `most`.
struct Dust {
    Dust(std::size_t n, double least, double most) : mesh(cube_sphere(40, 0.002)) {
        for (std::size_t i = 0; i < n; ++i) {
            const double share = static_cast<double>(i) / static_cast<double>(n);
            const double angle = 6.2831853 * share;
            centers.push_back({1.6 * std::cos(angle), 1.6 * std::sin(angle), 0});
            radii.push_back(least * std::pow(most / least, share));
            const double r = radii.back();
            mesh = joined(mesh, translated(scaled(cube_sphere(3), {r, r, r}), centers.back()));
        }
    }
    /// Diagonal of the box of a small one.
    [[nodiscard]] double size(std::size_t i) const { return 2 * std::sqrt(3.0) * radii[i]; }
    /// `lod` has a vertex near the small one; a tetrahedron around a sphere reaches out to three
    /// times its radius.
    [[nodiscard]] bool is_in(const Mesh& lod, std::size_t i, double cell) const {
        for (const Vec3& p : lod.positions) {
            if (distance(p, centers[i]) <= 3.5 * radii[i] + 2 * cell) return true;
        }
        return false;
    }

    Mesh mesh;
    std::vector<Vec3> centers;
    std::vector<double> radii;
};

}  // namespace hewer::test
