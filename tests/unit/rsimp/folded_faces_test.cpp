// SPDX-License-Identifier: MIT
#include "rsimp/folded_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/block_mesh.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/stored_mesh.h"

namespace hewer::rsimp {
namespace {

/// A plane of n x n squares of size 1, in the ids' order, with samples of the plane.
class Folded : public testing::Test {
  protected:
    static constexpr std::uint64_t kSquares = 12;

    Folded() : mesh_(test::scaled(test::plane_grid(kSquares), {kSquares, kSquares, 1})) {
        ids_.resize(mesh_.positions.size());
        for (std::size_t i = 0; i < ids_.size(); ++i) ids_[i] = vertex_id(i, 0);
        samples_ = {context_, "samples"};
        for (double x = 0.1; x < kSquares; x += 0.4) {
            for (double y = 0.1; y < kSquares; y += 0.4) {
                samples_.push(FitSample(kOffset + Vec3{x, y, 0}, {0, 0, 1}, 0.16));
            }
        }
    }

    /// Drags the vertex at (x, y).
    void drag(std::uint64_t x, std::uint64_t y, const Vec3& by) {
        Vec3& p = mesh_.positions[x * (kSquares + 1) + y];
        p = p + by;
    }
    FoldedFaces unfold(bool may_move) {
        for (Vec3& p : mesh_.positions) p = p + kOffset;
        store_ = test::store_mesh(context_, mesh_, ids_);
        const std::vector<cluster::OctreeBox> boxes{{0, 63}};
        const std::vector<std::uint64_t> first{0, ids_.size()};
        return unfold_faces(context_, store_, samples_, boxes, first, may_move ? 1e9 : 0,
                            {test::kStoreOrigin, 1});
    }
    [[nodiscard]] std::size_t count_turned() const {
        std::vector<Vec3> p(store_.vertices.size());
        for (std::size_t v = 0; v < p.size(); ++v) p[v] = store_.vertices.at(v).vertex.position;
        std::size_t n = 0;
        for (std::size_t f = 0; f < store_.faces.size(); ++f) {
            const LocalFace t{static_cast<std::uint32_t>(cluster_of(store_.faces.at(f)[0])),
                              static_cast<std::uint32_t>(cluster_of(store_.faces.at(f)[1])),
                              static_cast<std::uint32_t>(cluster_of(store_.faces.at(f)[2]))};
            if (cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]])[2] < 0) ++n;
        }
        return n;
    }

    static constexpr Vec3 kOffset{20, 20, 20};
    ooc::Context context_{ooc::ResourceLimits{.memory_bytes = 256 << 20, .n_threads = 2}};
    Mesh mesh_;
    std::vector<VertexId> ids_;
    ooc::Spool<FitSample> samples_;
    MeshStore store_;
};

TEST_F(Folded, OfAPlaneNoFaceIs) {
    const FoldedFaces folded = unfold(true);
    EXPECT_EQ(folded.faces, 0U);
    EXPECT_EQ(folded.unfolded, 0U);
}

TEST_F(Folded, FacesThatAVertexWasDraggedAcrossAreFoundWithTheirPlace) {
    drag(6, 6, {1.6, 0.3, 0});
    const FoldedFaces folded = unfold(false);
    EXPECT_GT(folded.faces, 0U);
    EXPECT_EQ(folded.faces, count_turned());
    EXPECT_EQ(folded.unfolded, 0U);
    ASSERT_EQ(folded.list.size(), folded.faces);
    for (const FoldedFace& face : folded.list) {
        EXPECT_NEAR(face.center[0], 20 + 7, 1);
        EXPECT_NEAR(face.center[1], 20 + 6, 1);
        EXPECT_LE(face.size, 3);
    }
}

TEST_F(Folded, TheyAreTurnedBack) {
    drag(6, 6, {1.6, 0.3, 0});
    drag(2, 9, {0, 0.1, 0.2});
    drag(3, 3, {-1.2, -1.3, 0});
    const FoldedFaces folded = unfold(true);
    EXPECT_EQ(folded.faces, 0U);
    EXPECT_GT(folded.unfolded, 0U);
    EXPECT_EQ(count_turned(), 0U);
}

TEST_F(Folded, BorderVerticesStay) {
    drag(0, 6, {1.3, 0, 0});
    const FoldedFaces folded = unfold(true);
    EXPECT_EQ(folded.faces, count_turned());
    EXPECT_NEAR(store_.vertices.at(6).vertex.position[0] + test::kStoreOrigin[0], 20 + 1.3, 1e-9);
}

TEST_F(Folded, TheOtherSideOfAThinSheetIsNoFold) {
    for (double x = 0.1; x < kSquares; x += 0.4) {
        for (double y = 0.1; y < kSquares; y += 0.4) {
            samples_.push(FitSample(kOffset + Vec3{x, y, -0.01}, {0, 0, -1}, 0.16));
        }
    }
    EXPECT_EQ(unfold(false).faces, 0U);
}

}  // namespace
}  // namespace hewer::rsimp
