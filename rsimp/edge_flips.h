// SPDX-License-Identifier: MIT
/// Edges of a piece of mesh, flipped where that brings its faces nearer to the original surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/indexed_heap.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

/// The edge swaps of Hoppe's mesh optimisation (1993), all of them at once: every point keeps to
/// its nearest face; an edge ab between the faces abc and bad becomes cd where the points of the
/// two are nearer to the faces cad and dbc then; the largest gain first, until there is none. Each
/// flip takes a share off the sum of squares, so there is an end. Points say little of what lies
/// between them: the middle of the new edge counts against it where it is farther from the surface
/// than that of the old one.
///
/// No vertex moves, and topology stays: an edge is flipped only if c and d are no neighbours, and
/// if neither face turns far. Only faces whose corners are all the piece's own change, so pieces do
/// not meet. Creases are followed, since that is where the gain is.
///
/// Memory: kBytesPerPoint, kBytesPerFace; some 100 bytes a face while flip() runs, when the tree of
/// the faces may be gone.
class EdgeFlips {
  public:
    static constexpr std::uint64_t kBytesPerPoint = sizeof(WeightedPoint) + 12;
    static constexpr std::uint64_t kBytesPerFace = 32;

    explicit EdgeFlips(const MeshPiece& piece);

    /// Takes the point if its face might change, and does not show it its back.
    bool take(const WeightedPoint& point, std::uint32_t nearest_face, float squared);

    struct Change {
        LocalFace before;
        LocalFace after;
    };
    /// Changes faces of `piece`, which must be the one of the constructor, and says which. Idle
    /// threads look for first gains, too.
    std::vector<Change> flip(ooc::Workers& workers, MeshPiece& piece);

    [[nodiscard]] std::uint64_t n_flips() const { return n_flips_; }

    /// visit(point, face, squared distance) for what was taken, in that order.
    template <typename Visit>
    void for_each_point(const Visit& visit) const {
        for (std::size_t i = 0; i < points_.size(); ++i) visit(points_[i], face_[i], squared_[i]);
    }

  private:
    /// Faces f and g, what they become, and the half-edges on the other side of the outer edges of
    /// that: of the corners 0 and 1 of each. The new edge goes from corner 2.
    struct Flip {
        std::uint32_t f, g;
        LocalFace new_f, new_g;
        std::array<std::uint32_t, 2> across_f, across_g;
    };

    void find_neighbours();
    void find_fixed_vertices();
    [[nodiscard]] std::uint32_t start_of(std::uint32_t half_edge) const;
    [[nodiscard]] bool are_neighbours(std::uint32_t half_edge, std::uint32_t vertex) const;
    [[nodiscard]] bool describe(std::uint32_t half_edge, Flip& flip) const;
    [[nodiscard]] bool keeps_shape(const Flip& flip) const;
    [[nodiscard]] double cost_of_middles(const Flip& flip) const;
    [[nodiscard]] float gain_of(std::uint32_t half_edge) const;
    void offer(std::uint32_t half_edge);
    void carry_out(const Flip& flip);

    const std::vector<Vec3>& positions_;
    std::uint32_t n_own_;
    std::vector<LocalFace> faces_;
    std::vector<std::uint32_t> across_;  // by half-edge
    std::vector<bool> is_fixed_;         // own vertices around which faces are no single fan
    std::vector<WeightedPoint> points_;
    std::vector<std::uint32_t> face_;     // of each point
    std::vector<float> squared_;          // distance of each point
    std::vector<std::uint32_t> next_;     // point of the same face
    std::vector<std::uint32_t> first_;    // point of each face
    std::vector<std::uint32_t> at_hand_;  // points of two faces
    IndexedHeap heap_{0};                 // half-edges by gain, below zero
    std::uint64_t n_flips_ = 0;
};

}  // namespace hewer::rsimp
