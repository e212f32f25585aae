// SPDX-License-Identifier: MIT
/// Error quadrics: the weighted sum of squared distances to planes (and border lines) as a function
/// of the point. Garland & Heckbert 1997; area weights.
#pragma once

#include <array>
#include <cstddef>

#include "ooc/vec3.h"

namespace hewer::cluster {

/// E(x) = x.A x + 2 b.x + c, x relative to an origin that the owner knows. Quadrics with the same
/// origin add.
struct Quadric {
    Symmetric3 a{};
    Vec3 b{};
    double c = 0;

    Quadric& operator+=(const Quadric& q) {
        for (std::size_t i = 0; i < 6; ++i) a[i] += q.a[i];
        for (std::size_t i = 0; i < 3; ++i) b[i] += q.b[i];
        c += q.c;
        return *this;
    }
    /// Weighted squared distance at x. Rounding can make it slightly negative.
    [[nodiscard]] double error(const Vec3& x) const { return dot(x, a * x) + 2 * dot(b, x) + c; }
    /// The same quadric for coordinates relative to `origin` (given in the present ones).
    [[nodiscard]] Quadric relative_to(const Vec3& origin) const {
        Quadric q;
        q.a = a;
        q.b = a * origin + b;
        q.c = error(origin);
        return q;
    }
    [[nodiscard]] double trace() const { return a[0] + a[3] + a[5]; }
};

/// Eigenvalues in falling order with unit eigenvectors.
struct Eigen3 {
    std::array<double, 3> values{};
    std::array<Vec3, 3> vectors{};
};

/// Cyclic Jacobi: slow but exact to rounding, and only + - * / sqrt, so equal bits on every
/// machine.
Eigen3 eigen_decomposition(const Symmetric3& m);

/// The point that minimises `q` as seen from `mean` (same coordinates): directions in which the
/// quadric says next to nothing (eigenvalue <= kSingular of the largest) stay at the mean.
/// Lindstrom 2000, section 3.1, with the mean in place of the cell's centre.
Vec3 minimum_from(const Quadric& q, const Eigen3& eigen, const Vec3& mean);

/// Relative eigenvalue below which a direction counts as undetermined.
inline constexpr double kSingular = 1e-3;

}  // namespace hewer::cluster
