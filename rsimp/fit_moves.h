// SPDX-License-Identifier: MIT
/// How the vertices of a piece of mesh move in one round of the fit.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/distance_histogram.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

/// Where the own vertices should go for the mesh as a whole to come nearer to the points: one
/// majorised Jacobi step of Hoppe's mesh optimisation (1993) with fixed connectivity. Each point
/// pulls the corners of its nearest face along the residual, shared by barycentric weights b; a
/// vertex solves (sum b n n^T + little) x = sum b d n. Weights b instead of b^2 make the step a
/// majorisation: all vertices move at once and the sum of squares still falls; it is lengthened by
/// half, and no vertex goes farther than its longest residual.
///
/// The points see the faces, and hardly the vertices: these would stand out beyond every bend. So
/// each vertex is pulled a little to the surface at the point that is nearest to itself.
class FitMoves {
  public:
    /// Points farther than `most_distance` belong to something that has vanished and do not pull;
    /// nor do points whose nearest face shows them its back. The faces of `piece` may change
    /// between two pulls.
    FitMoves(const MeshPiece& piece, double most_distance);

    /// In an order where neighbours follow one another; the sums depend on it in their last bits.
    void pull(const WeightedPoint& point, std::uint32_t nearest_face, float squared);

    [[nodiscard]] std::vector<Vec3> moves() const;
    /// Of the points whose nearest face is near enough and has an own corner.
    [[nodiscard]] const DistanceHistogram& distances() const { return distances_; }

  private:
    struct Pull {
        Symmetric3 matrix{};
        Vec3 residual{};
        double longest = 0;  // residual
        // Of the points that pull, the one nearest to the vertex: squared distance, where it is
        // from the vertex, and what way it faces.
        double nearest = std::numeric_limits<double>::infinity();
        Vec3 to_nearest{};
        Vec3 front{};

        void add(const Vec3& n, double d, double weight);
    };

    const MeshPiece& piece_;
    float most_;               // squared
    std::vector<Pull> pulls_;  // by own vertex
    DistanceHistogram distances_;
};

/// Which of the own vertices must stay: those with a face that would turn by more than 60 degrees,
/// or by more than 80 from what it was before the fit (`at_first`, the positions then), if any
/// subset of its corners moved. So what becomes of the other corners does not matter, and no face
/// ever folds. `moves` are of all vertices of the piece.
std::vector<bool> held_vertices(const MeshPiece& piece, std::span<const Vec3> at_first,
                                std::span<const Vec3> moves);

}  // namespace hewer::rsimp
