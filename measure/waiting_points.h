// SPDX-License-Identifier: MIT
/// Points that wait for the nearest of the triangles that stream past.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "measure/piece.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

/// The distance from each of some points, which are in memory, to a surface that is not: it passes
/// twice, as points and as triangles.
///
/// 1. note() is shown points of the surface, the more the better: vertices. A hash grid keeps one
///    of them a cell, so that settle() finds for each waiting point one that is near: its distance
///    is a limit to what can be nearest.
/// 2. settle() makes a packed tree of boxes over the points, each with the largest limit in it.
/// 3. meet() is shown the triangles, in any order, on any threads. Triangles that follow each other
///    are looked up in the tree together as long as they are close together; most are beyond all
///    limits but a few. A triangle that is nearer than all before lowers a point's limit, and a
///    search lowers those of the boxes that it comes through to what is left in them.
///
/// Whatever the limits, the result is the least of squared_distance() over all triangles, to the
/// bit: limits only decide how much is looked at in vain. Points should come in an order that is
/// coherent in space: eight that follow each other make a leaf.
///
/// A piece of surface waits as its center does, for a triangle that is within a given distance of
/// all of it: only triangles that are so near to the center are looked at.
///
/// Memory: 52 bytes a point, and the grid: 8 to 16 bytes a point until settle() (see bytes()); 124
/// bytes a piece.
class WaitingPoints {
  public:
    WaitingPoints() = default;
    /// `points` in steps, each coordinate within +-kLatticeRadius. The surface to come has about
    /// `area` square steps.
    WaitingPoints(ooc::Context& context, ooc::Array<Vec3> points, double area);
    /// Pieces, ready to meet(): they need no limits. squared_distance() is the least of those of
    /// squared_distance(Piece) for the triangles within `enough` square steps of the center, and
    /// infinity if there is none; one that is not above `enough` may be any. Of several triangles
    /// at the least distance the first in order is nearest().
    WaitingPoints(ooc::Context& context, ooc::Array<Piece> pieces, double enough);

    /// Thread-safe.
    void note(const LatticePoint& p) {
        const std::atomic_ref<std::uint64_t> slot(grid_[slot_of(cell_of(p))]);
        if (slot.load(std::memory_order_relaxed) == 0) {
            slot.store(pack(p), std::memory_order_relaxed);
        }
    }
    /// `far` are some points of the surface, not none, for those that no noted point is near to.
    /// Throws: OutOfMemoryBudget, Cancelled.
    void settle(ooc::Context& context, ooc::Array<LatticeTriangle> far, std::uint64_t n_far);

    /// Thread-safe.
    void meet(std::span<const LatticeTriangle> triangles);

    [[nodiscard]] std::uint64_t size() const { return points_.size(); }
    [[nodiscard]] const Vec3& point(std::uint64_t i) const { return points_[i]; }
    [[nodiscard]] const Piece& piece(std::uint64_t i) const { return pieces_[i]; }
    [[nodiscard]] const LatticeTriangle& nearest(std::uint64_t i) const { return nearest_[i]; }
    /// Infinity if no triangle came.
    [[nodiscard]] double squared_distance(std::uint64_t i) const { return best_[i]; }

    /// Bytes for `n` points, the points included.
    static std::uint64_t bytes(std::uint64_t n);
    /// The same for pieces.
    static std::uint64_t piece_bytes(std::uint64_t n) {
        return bytes(n) + n * (sizeof(Piece) + sizeof(LatticeTriangle)) -
               n_slots(n) * sizeof(std::uint64_t);
    }

  private:
    static constexpr std::size_t kLeaf = 8;    // points
    static constexpr std::size_t kFanOut = 8;  // children
    static constexpr std::size_t kLocks = 64;

    /// Points rounded to the lattice, and the squares of their limits, with slack.
    struct Leaf {
        std::array<std::array<std::int32_t, kLeaf>, 3> at;
        std::array<float, kLeaf> limit;
    };
    struct Box {
        LatticePoint lo;
        LatticePoint hi;
        float limit;  // largest; below 0: nothing in it
    };
    /// The boxes of the children.
    struct Node {
        std::array<std::array<std::int32_t, kFanOut>, 3> lo;
        std::array<std::array<std::int32_t, kFanOut>, 3> hi;
        std::array<float, kFanOut> limit;
    };
    using Cell = std::array<std::int32_t, 3>;

    [[nodiscard]] Cell cell_of(const LatticePoint& p) const {
        return {p[0] >> cell_bits_, p[1] >> cell_bits_, p[2] >> cell_bits_};
    }
    [[nodiscard]] std::uint64_t slot_of(const Cell& cell) const {
        std::uint64_t h = 0;
        for (const std::int32_t x : cell) {
            h = (h ^ static_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ULL;
            h ^= h >> 29;
        }
        return h & (grid_.size() - 1);
    }
    static std::uint64_t pack(const LatticePoint& p);
    static Vec3 unpack(std::uint64_t word);
    static std::uint64_t n_slots(std::uint64_t n);
    static std::uint64_t n_nodes(std::uint64_t n);

    [[nodiscard]] double distance_to_noted(const LatticePoint& p) const;
    void meet_point(std::uint64_t number, const LatticeTriangle& t, float& limit);
    void meet_piece(std::uint64_t number, const LatticeTriangle& t, float& limit);
    void make_arrays(ooc::Context& context);
    void fill_leaf(std::uint64_t leaf, std::span<const double> limits);
    [[nodiscard]] Box box_of_leaf(std::uint64_t leaf);
    [[nodiscard]] static Box box_of_node(Node& node);
    void fill_nodes(ooc::Context& context);
    /// Of triangles, a step wider on all sides: the points of leaves are rounded.
    struct Corners {
        LatticePoint lo;
        LatticePoint hi;
    };
    static HEWER_INLINE Corners corners_of(const LatticeTriangle& t) {
        Corners box;
        for (std::size_t k = 0; k < 3; ++k) {
            box.lo[k] = std::min(std::min(t[0][k], t[1][k]), t[2][k]) - 1;
            box.hi[k] = std::max(std::max(t[0][k], t[1][k]), t[2][k]) + 1;
        }
        return box;
    }
    static std::array<float, kFanOut> child_distances(const Node& node, const Corners& box);
    void meet_group(std::span<const LatticeTriangle> group, const Corners& box);
    void meet_leaf(std::uint64_t leaf, const LatticeTriangle& t, const Corners& box);

    ooc::Array<Vec3> points_;
    ooc::Array<double> best_;  // squared
    // Of pieces, or empty: the points are their centers.
    ooc::Array<Piece> pieces_;
    ooc::Array<LatticeTriangle> nearest_;
    double enough_ = 0;  // squared
    std::unique_ptr<std::array<std::mutex, kLocks>> locks_;
    ooc::Array<Leaf> leaves_;
    ooc::Array<Node> nodes_;             // the parents of leaves first; the root last
    std::vector<std::uint64_t> levels_;  // first node of each
    int cell_bits_ = 0;
    ooc::Array<std::uint64_t> grid_;  // packed points; 0: none
};

}  // namespace hewer::measuring
