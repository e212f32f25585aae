// SPDX-License-Identifier: MIT
/// The face of a piece of mesh that is nearest to a point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rsimp/mesh_piece.h"

namespace hewer::rsimp {

/// A packed tree of boxes over faces in the order of the Morton codes of their centres: kLeaf faces
/// a leaf, kFanOut children a node, no pointers; all of a leaf or node is tested at once. In single
/// precision, which is enough for pieces whose extent is some thousand times the distances looked
/// for (measuring::TriangleIndex is exact, and slower to build).
///
/// Memory: 76 bytes a face, 200 a node of 64 faces.
class FaceTree {
  public:
    struct Hit {
        float squared_distance;
        std::uint32_t slot;  ///< place of the face in the tree: a guess for the next search
        std::uint32_t face;  ///< its place in `faces`
    };
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// Faces may be degenerate. O(n log n).
    FaceTree(std::span<const Point3f> points, std::span<const LocalFace> faces);

    /// Precondition, here and below: `p` is finite, and there are faces.
    /// The nearest face if its squared distance is at most `most`, else one with face == kNone.
    /// `guess` is the slot of any face; the nearer it is, the shorter the search.
    [[nodiscard]] Hit nearest(const Point3f& p, float most, std::uint32_t guess) const;

    /// The same for points that follow each other, most of them near the one before: a few of them
    /// share each walk through the tree. `guess` goes on from call to call, and changes no hit.
    void nearest(std::span<const Point3f> points, float most, std::uint32_t& guess,
                 std::span<Hit> hits) const;

  private:
    static constexpr std::size_t kLeaf = 8;
    static constexpr std::size_t kFanOut = 8;

    /// Eight numbers that the compiler keeps in one or two registers.
    using Lanes = float __attribute__((vector_size(32)));
    static_assert(sizeof(Lanes) == kLeaf * sizeof(float) && kLeaf == kFanOut);
    /// Corner, edges to the other two, and what of their products the distance takes.
    struct alignas(32) Leaf {
        std::array<Lanes, 3> a, ab, ac;
        Lanes ab_ab, ab_ac, ac_ac, per_det, per_ab, per_ac, per_bc;
    };
    struct alignas(32) Node {
        std::array<Lanes, 3> low, high;
    };
    struct Level {
        std::uint32_t first;  // of its nodes
        std::uint32_t n_children;
    };

    void fill_leaf(std::uint32_t leaf, std::span<const Point3f> points,
                   std::span<const LocalFace> faces);
    void fill_nodes(std::span<const Point3f> points, std::span<const LocalFace> faces);
    static void distances_to_leaf(const Leaf& leaf, const Point3f& p, Lanes& squared);
    static void distances_to_node(const Node& node, const Point3f& p, Lanes& squared);
    void search_leaf(std::uint32_t leaf, const Point3f& p, Hit& best) const;

    /// Leaves that a group of points may be nearest to: their boxes, and which they are.
    static constexpr std::size_t kMostNear = 32;
    struct NearLeaves {
        std::array<Node, kMostNear / kFanOut> boxes;
        std::array<std::uint32_t, kMostNear> leaves;
        std::size_t n;  ///< kMostNear + 1 if there are more
    };
    void leaves_within(const Point3f& p, float distance, NearLeaves& near) const;
    void search_near(const NearLeaves& near, const Point3f& p, std::uint32_t guess,
                     Hit& best) const;
    bool nearest_of_group(std::span<const Point3f> group, float most, std::uint32_t guess,
                          Hit* hits) const;

    std::vector<std::uint32_t> order_;  // of faces, by slot
    std::vector<Leaf> leaves_;
    std::vector<Node> nodes_;  // parents of leaves first, the root last
    std::vector<Level> levels_;
};

}  // namespace hewer::rsimp
