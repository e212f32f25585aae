// SPDX-License-Identifier: MIT
/// The distance from a point to a triangle.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

namespace detail {

HEWER_INLINE Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
HEWER_INLINE double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
HEWER_INLINE Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// From the point at `from_start` (relative to the start of the segment) to the segment along
/// `edge`.
HEWER_INLINE double squared_distance_to_segment(const Vec3& from_start, const Vec3& edge) {
    const double along = dot(from_start, edge);
    const double length2 = dot(edge, edge);
    const double t = along <= 0 ? 0 : (along >= length2 ? 1 : along / length2);
    const Vec3 d{from_start[0] - t * edge[0], from_start[1] - t * edge[1],
                 from_start[2] - t * edge[2]};
    return dot(d, d);
}

}  // namespace detail

/// Squared distance in square steps from `q` (in steps) to the closed triangle `t`, which may be
/// degenerate: a segment or a point. Infinity may stand for a result above `limit`, and for no
/// other: so the least of the results over some triangles has the same bits whatever the order and
/// the limits with which they are visited.
///
/// Over the inside of the triangle it is the distance to its plane, elsewhere the least distance to
/// those edges that have `q` on their outer side. Unlike the walk over Voronoi regions (Ericson,
/// Real-Time Collision Detection, 5.1.5) no quotient of cancelling terms decides where the closest
/// point lies: needles of any aspect come out right to a few units of rounding of the distance
/// between `q` and the triangle's corners.
HEWER_INLINE double squared_distance(const Vec3& q, const LatticeTriangle& t,
                                     double limit = std::numeric_limits<double>::infinity()) {
    using namespace detail;
    const Vec3 a = to_double(t[0]);
    const Vec3 b = to_double(t[1]);
    const Vec3 c = to_double(t[2]);
    const Vec3 n = double_area_normal(t);
    const Vec3 qa = minus(q, a);
    const double n2 = dot(n, n);
    double to_plane2 = 0;
    if (n2 > 0) {
        const double h = dot(qa, n);
        // The product and the quotient below are rounded differently.
        constexpr double kSlack = 1 + 0x1p-48;
        if (h * h > limit * n2 * kSlack) return std::numeric_limits<double>::infinity();
        to_plane2 = h * h / n2;
    }
    const Vec3 qb = minus(q, b);
    const Vec3 qc = minus(q, c);
    const Vec3 ab = minus(b, a);
    const Vec3 bc = minus(c, b);
    const Vec3 ca = minus(a, c);
    const bool outside_ab = dot(cross(ab, qa), n) < 0;
    const bool outside_bc = dot(cross(bc, qb), n) < 0;
    const bool outside_ca = dot(cross(ca, qc), n) < 0;
    if (n2 > 0 && !outside_ab && !outside_bc && !outside_ca) return to_plane2;
    double least = std::numeric_limits<double>::infinity();
    if (outside_ab || n2 <= 0) least = squared_distance_to_segment(qa, ab);
    if (outside_bc || n2 <= 0) least = std::min(least, squared_distance_to_segment(qb, bc));
    if (outside_ca || n2 <= 0) least = std::min(least, squared_distance_to_segment(qc, ca));
    return std::max(least, to_plane2);
}

}  // namespace hewer::measuring
