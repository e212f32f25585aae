// SPDX-License-Identifier: MIT
/// Small surfaces for the tests of measure/.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "hewer/mesh_source.h"

namespace hewer::test {

/// n x n squares of two triangles over [0, size]^2 at height z.
inline Mesh plane(std::uint64_t n, double size, double z) {
    Mesh mesh;
    for (std::uint64_t i = 0; i <= n; ++i) {
        for (std::uint64_t j = 0; j <= n; ++j) {
            mesh.positions.push_back({size * static_cast<double>(i) / static_cast<double>(n),
                                      size * static_cast<double>(j) / static_cast<double>(n), z});
        }
    }
    for (std::uint64_t i = 0; i < n; ++i) {
        for (std::uint64_t j = 0; j < n; ++j) {
            const std::uint64_t a = i * (n + 1) + j;
            const std::uint64_t b = a + n + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    }
    return mesh;
}

/// Rings and segments of equal angle, poles included (as zero-area triangles too).
inline Mesh sphere(std::uint64_t n_rings, double radius, const Vec3& center = {0, 0, 0}) {
    Mesh mesh = plane(n_rings, 1, 0);
    for (Vec3& p : mesh.positions) {
        const double polar = std::numbers::pi * p[0];
        const double turn = 2 * std::numbers::pi * p[1];
        p = {center[0] + radius * std::sin(polar) * std::cos(turn),
             center[1] + radius * std::sin(polar) * std::sin(turn),
             center[2] + radius * std::cos(polar)};
    }
    return mesh;
}

inline Mesh translated(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) {
        for (std::size_t k = 0; k < 3; ++k) p[k] += by[k];
    }
    return mesh;
}

}  // namespace hewer::test
