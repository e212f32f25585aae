// SPDX-License-Identifier: MIT
/// How the vertices at the borders of a piece of mesh move in one round of the fit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/face_tree.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

/// FitMoves for curves: points of the original border pull the ends of the nearest border edge,
/// across that edge and not along it, so that vertices slide where the border is straight. The
/// surface does not pull at a border: it would draw it in where the surface bends. Where there are
/// more border edges than faces, the surface is in shreds and its borders stay.
///
/// Memory: 24 bytes a face while borders are looked for, then some 110 a border edge and 80 an own
/// vertex: less than FitMoves takes.
class BorderMoves {
  public:
    /// Points farther than `most_distance` do not pull, nor do those where the border runs the
    /// other way: they are on the other side of a narrow gap.
    BorderMoves(const MeshPiece& piece, double most_distance);

    /// Else there is nothing to replace().
    [[nodiscard]] bool has_border() const { return has_border_; }

    /// Points along the border, with their length as weight and its direction as normal.
    void pull(std::span<const WeightedPoint> points);

    /// Puts the moves of the own vertices at borders into the place of those in `moves`; a vertex
    /// that hardly any point pulls stays, and so does one at an edge with more than two faces.
    void replace(std::span<Vec3> moves) const;

  private:
    struct Pull {
        Symmetric3 matrix{};
        Vec3 residual{};
        double longest = 0;
        std::uint32_t n_points = 0;
    };
    const MeshPiece& piece_;
    float most_;                    // squared
    std::vector<bool> is_fixed_;    // own vertices that the surface must not move
    std::vector<LocalFace> edges_;  // from, to, to
    FaceTree tree_;
    bool has_border_;
    std::uint32_t guess_ = 0;
    std::vector<Point3f> places_;
    std::vector<FaceTree::Hit> hits_;
    std::vector<Pull> pulls_;  // by own vertex
};

}  // namespace hewer::rsimp
