// SPDX-License-Identifier: MIT
#include "rsimp/finish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "rsimp/block_input.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/block_meshes.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();

/// Into the positive octant, coordinates up to about 200.
Mesh placed(const Mesh& mesh, double scale = 60) {
    return test::translated(test::scaled(mesh, {scale, scale, scale}), {100, 100, 100});
}

struct Finishing {
    Finishing(const Mesh& mesh, bool is_closed, std::uint64_t box_vertices,
              std::uint64_t block_vertices, unsigned n_threads = 2)
        : context(test::make_context(n_threads)),
          clusters(test::cluster_mesh(*context, mesh, box_vertices, is_closed)) {
        std::vector<cluster::OctreeBox> boxes;
        std::vector<std::uint64_t> first;
        for (const ClusterMesh::Block& b : clusters.blocks) {
            boxes.push_back(b.box);
            first.push_back(b.first_cluster);
        }
        boxes.pop_back();
        finisher.emplace(*context, boxes, first, SurfaceKind{is_closed, false}, block_vertices);
    }
    Mesh run(const std::optional<CollapseTarget>& target, bool with_merges = false) {
        finisher->begin(ClusterInput(clusters), report);
        store = finisher->run(target, with_merges, report);
        return test::to_mesh(store);
    }

    std::unique_ptr<ooc::Context> context;
    ClusterMesh clusters;
    std::optional<Finisher> finisher;
    FinishReport report;
    MeshStore store;
};

}  // namespace

TEST(Finisher, WithoutATargetItKeepsAManifoldMeshAsItIs) {
    for (const std::uint64_t block : {20U, 100U, 100000U}) {
        const Mesh mesh = placed(test::cube_sphere(14, 0.01));
        Finishing setup(mesh, true, 15, block);
        const Mesh result = setup.run({});
        EXPECT_EQ(result.triangles.size(), mesh.triangles.size());
        EXPECT_EQ(result.positions.size(), mesh.positions.size());
        const test::Counts counts = test::count(result);
        EXPECT_TRUE(counts.is_clean() && counts.is_closed());
        EXPECT_EQ(counts.euler, 2);
        EXPECT_EQ(setup.report.lost_cells, 0U);
    }
}

TEST(Finisher, MeetsTheTargetExactlyHoweverSmallTheBlocks) {
    const Mesh mesh = placed(test::cube_sphere(30, 0.02));
    for (const std::uint64_t block : {30U, 200U, 1000U, 100000U}) {
        for (const std::uint64_t target : {8000U, 3000U, 1000U}) {
            Finishing setup(mesh, true, 25, block);
            const Mesh result = setup.run(CollapseTarget{target, kAny, {}});
            EXPECT_LE(result.triangles.size(), target);
            EXPECT_GE(result.triangles.size() * 100, target * 99) << block;
            const test::Counts counts = test::count(result);
            EXPECT_TRUE(counts.is_clean() && counts.is_closed()) << block << ' ' << target;
            EXPECT_EQ(counts.euler, 2);
        }
        Finishing setup(mesh, true, 25, block);
        const std::size_t n = setup.run(CollapseTarget{kAny, 2000, {}}).positions.size();
        EXPECT_LE(n, 2000U);
        EXPECT_GE(n, 1980U);
    }
}

TEST(Finisher, BordersSurviveSeams) {
    const Mesh mesh = placed(test::plane_grid(60, 0.02), 150);
    for (const std::uint64_t block : {40U, 500U, 100000U}) {
        Finishing setup(mesh, false, 30, block);
        const Mesh result = setup.run(CollapseTarget{1500, kAny, {}});
        const test::Counts counts = test::count(result);
        EXPECT_TRUE(counts.is_clean());
        EXPECT_EQ(counts.euler, 1) << block;  // no hole at a seam
        EXPECT_NEAR(static_cast<double>(result.triangles.size()), 1500, 15);
    }
}

TEST(Finisher, FoldedSurfacesBecomeManifoldAcrossSeams) {
    // A surface whose vertices are merged at random with near ones: folds everywhere.
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Mesh mesh = placed(test::cube_sphere(16, 0.1, seed));
        test::Random random(seed);
        std::vector<std::uint64_t> place(mesh.positions.size());
        for (std::size_t v = 0; v < place.size(); ++v) {
            place[v] = v < 40 ? v : v - random.below(40);
        }
        for (Triangle& t : mesh.triangles) t = {place[t[0]], place[t[1]], place[t[2]]};
        for (const std::uint64_t block : {15U, 120U, 100000U}) {
            Finishing setup(mesh, true, 12, block);
            const test::Counts counts = test::count(setup.run({}));
            EXPECT_TRUE(counts.is_closed()) << seed << ' ' << block;
            EXPECT_EQ(counts.split_fans + counts.degenerate + counts.unreferenced, 0U)
                << seed << ' ' << block;
            Finishing other(mesh, true, 12, block);
            const test::Counts fewer = test::count(other.run(CollapseTarget{600, kAny, {}}));
            EXPECT_TRUE(fewer.is_closed()) << seed << ' ' << block;
            EXPECT_EQ(fewer.split_fans + fewer.degenerate + fewer.unreferenced, 0U);
        }
    }
}

TEST(Finisher, ThreadsDoNotShow) {
    const Mesh mesh = placed(
        test::joined(test::cube_sphere(30, 0.03), test::translated(test::torus(50, 20), {2, 0, 0})),
        40);
    Finishing one(mesh, true, 50, 300, 1);
    const Mesh expected = one.run(CollapseTarget{3000, kAny, {}});
    for (const unsigned n_threads : {2U, 8U}) {
        Finishing setup(mesh, true, 50, 300, n_threads);
        const Mesh other = setup.run(CollapseTarget{3000, kAny, {}});
        EXPECT_EQ(other.triangles, expected.triangles);
        EXPECT_EQ(other.positions, expected.positions);
    }
}

TEST(Finisher, MergesTellWhereEveryVertexWent) {
    const Mesh mesh = placed(test::cube_sphere(24, 0.02));
    Finishing setup(mesh, true, 20, 150);
    setup.run({});
    MeshStore fine = std::move(setup.store);
    FinishReport report;
    setup.finisher->begin(StoreInput(fine, setup.finisher->first_cluster()), report);
    const MeshStore coarse = setup.finisher->run(CollapseTarget{1000, kAny, {}}, true, report);
    std::map<VertexId, VertexId> parent;
    for (const auto& [gone, kept] : report.merges) parent[gone] = kept;
    EXPECT_EQ(parent.size(), fine.vertices.size() - coarse.vertices.size());
    const auto find = [&](VertexId v) {
        while (parent.contains(v)) v = parent[v];
        return v;
    };
    std::vector<Face> fine_faces(fine.faces.size());
    fine.faces.read(0, fine_faces);
    std::vector<Face> mapped;
    for (const Face& f : fine_faces) {
        Face m{find(f[0]), find(f[1]), find(f[2])};
        if (m[0] == m[1] || m[1] == m[2] || m[0] == m[2]) continue;
        std::rotate(m.begin(), std::min_element(m.begin(), m.end()), m.end());
        mapped.push_back(m);
    }
    std::sort(mapped.begin(), mapped.end());
    std::vector<Face> coarse_faces(coarse.faces.size());
    coarse.faces.read(0, coarse_faces);
    EXPECT_EQ(mapped, coarse_faces);
}

TEST(Finisher, TheBoundOnDisplacementHoldsEverywhere) {
    const Mesh mesh = placed(test::cube_sphere(30));
    for (const std::uint64_t block : {100U, 100000U}) {
        Finishing setup(mesh, true, 40, block);
        const Mesh result = setup.run(CollapseTarget{0, 0, 9.0});
        EXPECT_LT(result.triangles.size(), mesh.triangles.size() / 2);
        std::vector<StoredVertex> vertices(setup.store.vertices.size());
        setup.store.vertices.read(0, vertices);
        for (const StoredVertex& v : vertices) {
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_LE(v.vertex.position[i] - static_cast<double>(v.vertex.box[i]), 9.001);
            }
        }
    }
}

}  // namespace hewer::rsimp
