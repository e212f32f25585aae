// SPDX-License-Identifier: MIT
#include "measure/piece_search.h"

#include <cstddef>
#include <limits>

namespace hewer::measuring {

namespace {
// Between looks at how much has been spent.
constexpr std::uint64_t kPerLook = 4096;
}  // namespace

PieceSearch::Nearest PieceSearch::find(const Vec3& q) {
    const Nearest nearest = walk_.nearest(q);
    if (nearest.squared_distance > limits_->near()) far_.add(q, nearest.squared_distance);
    return nearest;
}

/// A part of a piece that has been looked at.
void PieceSearch::add(const Piece& piece, const Pending& of) {
    Pending part{piece, {}};
    for (std::size_t c = 0; c < 3; ++c) {
        std::size_t same = 0;
        while (same < 3 && of.piece[same] != piece[c]) ++same;
        part.nearest[c] = same < 3 ? of.nearest[same] : find(to_double(piece[c]));
    }
    pending_.push_back(part);
}

void PieceSearch::check_piece(const Pending& pending) {
    const double near = limits_->near();
    const Piece& piece = pending.piece;
    // Of those nearest to its corners, the triangle that is nearest to all of the piece.
    Nearest best{std::numeric_limits<double>::infinity(), 0};
    for (const Nearest& n : pending.nearest) {
        if (n.squared_distance > near) return;  // far, and known to be
        const double d =
            squared_distance(piece, to_->triangles()[n.triangle], best.squared_distance);
        if (d <= near) return;
        if (d < best.squared_distance) best = {d, n.triangle};
    }
    if (limits_->is_hair(squared_radius(piece))) {
        far_.add(center_of(piece), best.squared_distance);
        return;
    }
    for (const Piece& part : rest_of(piece, to_->triangles()[best.triangle], near)) {
        add(part, pending);
    }
}

void PieceSearch::check(const LatticeTriangle& triangle) {
    const auto at = [&](std::size_t c) { return find(to_double(triangle[c])); };
    pending_.assign(1, {triangle, {at(0), at(1), at(2)}});
    std::uint64_t n = 0;
    while (!pending_.empty()) {
        const Pending pending = pending_.back();
        pending_.pop_back();
        if (++n % kPerLook == 0) {
            limits_->count(kPerLook);
            if (limits_->is_spent()) return;
        }
        check_piece(pending);
    }
    limits_->count(n % kPerLook);
}

}  // namespace hewer::measuring
