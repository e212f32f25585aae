// SPDX-License-Identifier: MIT
/// Whether all of a triangle is near a surface in memory.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "measure/far_places.h"
#include "measure/piece.h"
#include "measure/piece_limits.h"
#include "measure/triangle_index.h"

namespace hewer::measuring {

/// Takes parts away from triangles, each within the limit of one triangle of the surface, until
/// nothing is left or what is left is far. Of that surface, the triangles nearest to a piece's
/// corners are tried. What is found far, and where, depends on the triangle alone. One
/// thread; triangles that follow each other should be near each other.
class PieceSearch {
  public:
    /// `none`: where far places will be added to.
    PieceSearch(const TriangleIndex& to, PieceLimits& limits, FarPlaces none)
        : to_(&to), limits_(&limits), far_(std::move(none)), walk_(to) {}

    /// Gives up once the limits are spent.
    void check(const LatticeTriangle& triangle);
    [[nodiscard]] const FarPlaces& far() const { return far_; }

  private:
    using Nearest = TriangleIndex::Nearest;
    /// With what is nearest to its corners: a part of it asks for its own ones only.
    struct Pending {
        Piece piece;
        std::array<Nearest, 3> nearest;
    };

    /// The nearest triangle to `q`, which is far if that is.
    Nearest find(const Vec3& q);
    void check_piece(const Pending& pending);
    void add(const Piece& piece, const Pending& of);

    const TriangleIndex* to_;
    PieceLimits* limits_;
    FarPlaces far_;
    TriangleIndex::Walk walk_;
    std::vector<Pending> pending_;
};

}  // namespace hewer::measuring
