// SPDX-License-Identifier: MIT
/// Finds the triangle that is nearest to a point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// A packed tree of boxes over triangles that it holds itself, in its own order.
///
/// The triangles are reordered in place by median splits along the longest axis, each at a multiple
/// of the capacity of a subtree, so that every subtree but the last of its level is full: kLeaf
/// triangles a leaf, kFanOut children a node, and no pointers. Boxes are exact integers; what
/// rounding the search does is relative and allowed for, so that the triangle found is the nearest
/// in exact arithmetic to within a few units of rounding of the distances themselves.
///
/// Order and tree depend on the set of triangles alone, not on the order they come in nor on the
/// number of threads (equal triangles are interchangeable).
///
/// Memory: 36 bytes a triangle + 192 bytes for each node, of which there are
/// n/32 * (1 + 1/8 + 1/64 + ...): 42.9 bytes a triangle. Building needs nothing more.
class TriangleIndex {
  public:
    struct Nearest {
        double squared_distance = 0;  ///< square steps
        std::uint64_t triangle = 0;   ///< position in triangles()
    };

    TriangleIndex() = default;
    /// Takes the first `n` of `triangles`; n >= 1. O(n log n) time.
    /// Throws: OutOfMemoryBudget, Cancelled.
    TriangleIndex(ooc::Context& context, ooc::Array<LatticeTriangle> triangles, std::uint64_t n);

    /// The triangles in the order of the tree: neighbours in it are mostly neighbours in space.
    [[nodiscard]] std::span<const LatticeTriangle> triangles() const {
        return triangles_.span().first(n_);
    }

    /// The triangle nearest to `q` (in steps, each coordinate within +-kLatticeRadius). `guess` is
    /// any triangle; the nearer it is to `q`, the shorter the search. Of several at the same
    /// distance the first is named: the result does not depend on the guess. Thread-safe.
    [[nodiscard]] Nearest nearest(const Vec3& q, std::uint64_t guess) const;

    /// Points that follow each other, most of them near the one before: each search begins with
    /// what the last one found. One thread.
    class Walk {
      public:
        explicit Walk(const TriangleIndex& index) : index_(&index) {}
        Nearest nearest(const Vec3& q) {
            const Nearest found = index_->nearest(q, last_);
            last_ = found.triangle;
            return found;
        }

      private:
        const TriangleIndex* index_;
        std::uint64_t last_ = 0;
    };

    /// Bytes for `n` triangles, the triangles included.
    static std::uint64_t bytes(std::uint64_t n);

  private:
    static constexpr std::size_t kLeaf = 4;    // triangles
    static constexpr std::size_t kFanOut = 8;  // children: two vectors of four
    static constexpr std::size_t kMaxLevels = 22;

    /// The boxes of the children, one array an axis and side, so that all eight are tested at once.
    struct Node {
        std::array<std::array<std::int32_t, kFanOut>, 3> lo;
        std::array<std::array<std::int32_t, kFanOut>, 3> hi;
    };
    struct Level {
        std::uint64_t first = 0;       // of its nodes
        std::uint64_t n_children = 0;  // of all its nodes together: nodes or leaves
    };

    static std::uint64_t n_nodes(std::uint64_t n);
    void fill_boxes(ooc::Context& context);
    void fill_leaf_parents(std::uint64_t begin, std::uint64_t end);
    void fill_inner_nodes(std::size_t level, std::uint64_t begin, std::uint64_t end);

    static std::array<float, kFanOut> child_distances(const Node& node, const LatticePoint& p);
    void search_leaf(std::uint64_t leaf, const Vec3& q, const LatticePoint& p, Nearest& best,
                     float& limit) const;

    ooc::Array<LatticeTriangle> triangles_;
    ooc::Array<Node> nodes_;  // level 0, the parents of leaves, first; the root last
    std::array<Level, kMaxLevels> levels_{};
    std::size_t n_levels_ = 0;
    std::uint64_t n_ = 0;
};

}  // namespace hewer::measuring
