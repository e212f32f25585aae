// SPDX-License-Identifier: MIT
#include "measure/piece.h"

#include <algorithm>
#include <cmath>

#include "ooc/triangle_foot.h"
#include "ooc/vec3.h"

namespace hewer::measuring {

namespace {

// Of the area of a piece: less is not worth a cut.
constexpr double kLeastPart = 1.0 / 16;
// Of the distance that is near enough: a cut is where this much is left of an edge.
constexpr double kAim = 0.99;
// To a cut; two or three do for most.
constexpr int kMostSteps = 12;
// Steps. Where an edge is shorter, rounding decides where its cut is: the cuts of needles would
// move nothing.
constexpr double kShortEdge = 1 << 12;

bool has_short_edge(const Piece& piece) {
    return squared_edge(piece, 0) < kShortEdge * kShortEdge ||
           squared_edge(piece, 1) < kShortEdge * kShortEdge ||
           squared_edge(piece, 2) < kShortEdge * kShortEdge;
}

struct Cut {
    LatticePoint point;
    double share = 0;  // of the edge
};

LatticePoint between(const LatticePoint& a, const LatticePoint& b, double share) {
    LatticePoint p{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double span = static_cast<double>(std::int64_t{b[k]} - a[k]);
        p[k] = static_cast<std::int32_t>(a[k] + std::llrint(share * span));
    }
    return p;
}

/// The last point from `a`, which is near, to `b`, which is not, that is near, or one somewhat
/// before it.
///
/// The distance along an edge is a convex function, and a tangent of it is below it: Newton's steps
/// from b to a point that is a little nearer than it must be do not go beyond that, and come to be
/// near after a few.
Cut last_near(const LatticePoint& a, const LatticePoint& b, const LatticeTriangle& t, double near) {
    const double aim = kAim * std::sqrt(near);
    const std::array<Vec3, 3> corners{to_double(t[0]), to_double(t[1]), to_double(t[2])};
    const Vec3 edge = to_double(b) - to_double(a);
    Cut cut{b, 1};
    for (int i = 0; i < kMostSteps; ++i) {
        const Vec3 p = to_double(cut.point);
        const auto w = foot_of(p, corners[0], corners[1], corners[2]).weights;
        const Vec3 way = p - (w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]);
        const double distance = std::sqrt(dot(way, way));
        const double slope = dot(way, edge) / distance;
        // Not so for an edge that goes nowhere, and where rounding decides.
        if (!(slope > 0 && distance > aim)) break;
        cut.share -= (distance - aim) / slope;
        if (!(cut.share > 0)) break;
        cut.point = between(a, b, cut.share);
        if (squared_distance(to_double(cut.point), t, near) <= near) return cut;
    }
    return {a, 0};
}

}  // namespace

Pieces halves_of(const Piece& piece) {
    const std::size_t e = longest_edge(piece);
    const LatticePoint& a = piece[e];
    const LatticePoint& b = piece[(e + 1) % 3];
    const LatticePoint& c = piece[(e + 2) % 3];
    LatticePoint middle{};
    for (std::size_t k = 0; k < 3; ++k) {
        middle[k] = static_cast<std::int32_t>((std::int64_t{a[k]} + b[k]) >> 1);
    }
    return {{Piece{a, middle, c}, Piece{middle, b, c}}, 2};
}

Pieces rest_of(const Piece& piece, const LatticeTriangle& t, double near) {
    std::array<bool, 3> is_near{};
    std::size_t n_near = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        is_near[c] = squared_distance(to_double(piece[c]), t, near) <= near;
        if (is_near[c]) ++n_near;
    }
    if (n_near == 3) return {};
    if (n_near == 0 || has_short_edge(piece)) return halves_of(piece);
    // The corner that is alone in being near or not, and the others.
    std::size_t alone = 0;
    while (is_near[alone] != (n_near == 1)) ++alone;
    const LatticePoint& a = piece[alone];
    const LatticePoint& b = piece[(alone + 1) % 3];
    const LatticePoint& c = piece[(alone + 2) % 3];
    if (n_near == 1) {
        const Cut p = last_near(a, b, t, near);
        const Cut q = last_near(a, c, t, near);
        if (p.share * q.share < kLeastPart) return halves_of(piece);
        return {{Piece{p.point, b, c}, Piece{p.point, c, q.point}}, 2};
    }
    const Cut p = last_near(b, a, t, near);
    const Cut q = last_near(c, a, t, near);
    if (1 - (1 - p.share) * (1 - q.share) < kLeastPart) return halves_of(piece);
    return {{Piece{a, p.point, q.point}}, 1};
}

}  // namespace hewer::measuring
