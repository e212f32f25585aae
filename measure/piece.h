// SPDX-License-Identifier: MIT
/// Pieces of triangles, as small as a proof needs them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "measure/triangle_distance.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

/// A triangle whose corners are on the lattice.
using Piece = LatticeTriangle;
/// Steps. Halving rounds a midpoint by less than one, and of the longest triangle there is nothing
/// left to halve after some 70 times: no point of a triangle is farther than this from the nearest
/// of its pieces.
constexpr double kRounding = 128;

inline Vec3 center_of(const Piece& piece) {
    Vec3 c{};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t sum = std::int64_t{piece[0][k]} + piece[1][k] + piece[2][k];
        c[k] = static_cast<double>(sum) / 3;
    }
    return c;
}

/// Square of the distance from center_of() to the farthest corner.
inline double squared_radius(const Piece& piece) {
    const Vec3 c = center_of(piece);
    double most = 0;
    for (const LatticePoint& p : piece) {
        const Vec3 d = detail::minus(to_double(p), c);
        most = std::max(most, detail::dot(d, d));
    }
    return most;
}

/// An upper bound of the squared distance from any point of `piece` to `t`: that of its farthest
/// corner, since the distance to a convex set is a convex function. Infinity may stand for a result
/// above `limit`, as in squared_distance().
HEWER_INLINE double squared_distance(const Piece& piece, const LatticeTriangle& t,
                                     double limit = std::numeric_limits<double>::infinity()) {
    double most = 0;
    for (const LatticePoint& p : piece) {
        most = std::max(most, squared_distance(to_double(p), t, limit));
        if (most > limit) break;
    }
    return most;
}

/// The edge from corner e to the next one, squared.
inline double squared_edge(const Piece& piece, std::size_t e) {
    const Vec3 d = detail::minus(to_double(piece[(e + 1) % 3]), to_double(piece[e]));
    return detail::dot(d, d);
}

/// Of several the first.
inline std::size_t longest_edge(const Piece& piece) {
    std::size_t longest = 0;
    for (std::size_t e = 1; e < 3; ++e) {
        if (squared_edge(piece, e) > squared_edge(piece, longest)) longest = e;
    }
    return longest;
}

/// Up to two pieces.
struct Pieces {
    std::array<Piece, 2> list;
    std::size_t n = 0;

    [[nodiscard]] const Piece* begin() const { return list.data(); }
    [[nodiscard]] const Piece* end() const { return list.data() + n; }
};

/// At the midpoint of the longest edge.
Pieces halves_of(const Piece& piece);

/// What is left of `piece` without a part that is within `near` square steps of `t`. Points so near
/// to a triangle are a convex set, so a part is if its corners are: those of the piece that are,
/// and on the edges to the other ones the last point that is. Where that would take little, the
/// piece is halved across its longest edge.
///
/// So pieces come to end at the edges of the other surface instead of becoming as small as `near`
/// there: a flat region is covered by as many of them as it has overlaps of triangles.
Pieces rest_of(const Piece& piece, const LatticeTriangle& t, double near);

}  // namespace hewer::measuring
