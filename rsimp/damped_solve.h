// SPDX-License-Identifier: MIT
/// Small symmetric systems that may say nothing about some directions.
#pragma once

#include "ooc/vec3.h"

namespace hewer::rsimp {

/// x of (m + damping * trace(m)) x = r, by Cramer's rule: the damping keeps the matrix away from
/// singular, and lets x stay where m says nothing. Zero if m is.
inline Vec3 damped_solve(Symmetric3 m, const Vec3& r, double damping) {
    constexpr double kTiny = 1e-12;
    const double added = damping * (m[0] + m[3] + m[5]);
    if (!(added > kTiny)) return {};
    m[0] += added;
    m[3] += added;
    m[5] += added;
    const Vec3 row0{m[0], m[1], m[2]};
    const Vec3 row1{m[1], m[3], m[4]};
    const Vec3 row2{m[2], m[4], m[5]};
    const Vec3 c12 = cross(row1, row2);
    const double det = dot(row0, c12);
    return (1 / det) * (r[0] * c12 + r[1] * cross(row2, row0) + r[2] * cross(row0, row1));
}

}  // namespace hewer::rsimp
