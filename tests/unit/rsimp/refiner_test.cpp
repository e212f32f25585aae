// SPDX-License-Identifier: MIT
/// Cluster trees, cuts, and the fusion of the uniform method.
#include "rsimp/refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>
#include <vector>

#include "rsimp/cluster_tree.h"
#include "rsimp/octree_fusion.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

using cluster::CellStore;

/// One tree over a whole store.
struct WholeTree {
    explicit WholeTree(const Mesh& mesh, double resolution)
        : context(test::make_context()),
          store(test::cluster_mesh(*context, mesh, resolution)),
          position(store.cells.size()),
          tree(0, store.cells.size()) {
        std::iota(position.begin(), position.end(), 0U);
        tree.set_faces(0, store.triangles.size());
    }
    void grow(double threshold, Priority priority = Priority::Quadric) {
        tree.grow({store, position, priority}, threshold);
    }
    /// The clusters of a cut as sets of cell ids.
    [[nodiscard]] std::set<std::set<std::uint32_t>> cut(double threshold) const {
        std::set<std::set<std::uint32_t>> clusters;
        tree.for_each_cluster(threshold, [&](const ClusterNode& node) {
            std::set<std::uint32_t> ids;
            for (std::uint32_t i = node.cell_begin; i < node.cell_end; ++i) {
                ids.insert(store.cells[i].id);
            }
            clusters.insert(ids);
        });
        return clusters;
    }

    std::unique_ptr<ooc::Context> context;
    CellStore store;
    std::vector<std::uint32_t> position;
    ClusterTree tree;
};

std::multiset<cluster::CellTriple> faces_of(const CellStore& store) {
    return {store.triangles.begin(), store.triangles.end()};
}

void expect_all_used(const Clusters& clusters) {
    std::vector<std::uint64_t> n_cells(clusters.size());
    for (const std::uint32_t c : clusters.cluster_of_cell) ++n_cells.at(c);
    EXPECT_EQ(std::count(n_cells.begin(), n_cells.end(), 0U), 0);
}

std::vector<std::uint32_t> numbers(const Clusters& clusters) {
    return {clusters.cluster_of_cell.begin(), clusters.cluster_of_cell.end()};
}

}  // namespace

TEST(ClusterTree, SubrangesAreDisjointCoveringAndNested) {
    for (const Mesh& mesh : {test::cube_sphere(25, 0.03), test::two_sheets(30, 0.05),
                             test::many_spheres(2, 8), test::random_soup(300, 900, 2)}) {
        WholeTree whole(mesh, 30);
        const auto faces_before = faces_of(whole.store);
        whole.grow(0);
        EXPECT_EQ(faces_of(whole.store), faces_before);
        const auto& nodes = whole.tree.nodes();
        EXPECT_EQ(nodes[0].cell_begin, 0U);
        EXPECT_EQ(nodes[0].cell_end, whole.store.cells.size());
        for (const ClusterNode& node : nodes) {
            // Exactly the faces of the subrange have two corners or more in the cluster.
            for (std::uint32_t f = 0; f < whole.store.triangles.size(); f += 7) {
                std::uint32_t inside = 0;
                for (const std::uint32_t id : whole.store.triangles[f]) {
                    const std::uint32_t at = whole.position[id];
                    inside += at >= node.cell_begin && at < node.cell_end ? 1U : 0U;
                }
                ASSERT_EQ(f >= node.face_begin && f < node.face_end, inside >= 2);
            }
            if (node.first_child == 0) continue;
            const ClusterNode& a = nodes[node.first_child];
            const ClusterNode& b = nodes[node.first_child + 1];
            EXPECT_EQ(a.cell_begin, node.cell_begin);
            EXPECT_LT(a.cell_begin, a.cell_end);
            EXPECT_EQ(a.cell_end, b.cell_begin);
            EXPECT_LT(b.cell_begin, b.cell_end);
            EXPECT_EQ(b.cell_end, node.cell_end);
            EXPECT_LE(node.face_begin, a.face_begin);
            EXPECT_EQ(a.face_end, b.face_begin);
            EXPECT_EQ(b.face_end, node.face_end);
            EXPECT_LE(a.key, node.key);
            EXPECT_LE(b.key, node.key);
        }
        for (std::uint32_t i = 0; i < whole.store.cells.size(); ++i) {
            EXPECT_EQ(whole.position[whole.store.cells[i].id], i);
        }
    }
}

TEST(ClusterTree, GrowingInStepsGivesTheSameCuts) {
    const Mesh mesh = test::cube_sphere(25, 0.03);
    WholeTree at_once(mesh, 30);
    at_once.grow(0.01);
    WholeTree in_steps(mesh, 30);
    for (const double threshold : {100.0, 5.0, 1.0, 0.2, 0.01}) in_steps.grow(threshold);
    for (const double threshold : {50.0, 1.0, 0.05, 0.01}) {
        EXPECT_EQ(at_once.cut(threshold), in_steps.cut(threshold));
    }
    EXPECT_GT(at_once.cut(0.01).size(), at_once.cut(1).size());
}

TEST(ClusterTree, EveryPriorityIsMonotone) {
    for (const Priority priority : {Priority::Quadric, Priority::Displacement}) {
        WholeTree whole(test::torus(60, 30), 40);
        whole.grow(0.1, priority);
        for (const ClusterNode& node : whole.tree.nodes()) {
            if (node.first_child == 0) {
                EXPECT_TRUE(node.key <= 0.1 || node.cell_end - node.cell_begin == 1);
                continue;
            }
            EXPECT_GT(node.key, 0.1);
            EXPECT_LE(whole.tree.nodes()[node.first_child].key, node.key);
            EXPECT_LE(whole.tree.nodes()[node.first_child + 1].key, node.key);
        }
    }
}

TEST(Refiner, MakesAsManyClustersAsAskedOfOneBlockOrMany) {
    const auto context = test::make_context();
    for (const double resolution : {60.0, 400.0}) {
        for (const std::uint64_t n : {100U, 1000U, 4000U}) {
            CellStore store =
                test::cluster_mesh(*context, test::cube_sphere(110, 0.01), resolution);
            Refiner refiner(*context, store, Priority::Quadric);
            EXPECT_EQ(refiner.n_blocks() > 1, resolution > 100);
            const Clusters clusters = refiner.refine_to_count(n);
            EXPECT_LE(clusters.size(), n);
            EXPECT_GE(clusters.size(), n - 2);
            expect_all_used(clusters);
        }
    }
}

TEST(Refiner, AsksForMoreOfTheSameTree) {
    const auto context = test::make_context();
    const Mesh mesh = test::cube_sphere(60, 0.02);
    CellStore store = test::cluster_mesh(*context, mesh, 80);
    Refiner refiner(*context, store, Priority::Quadric);
    const Clusters coarse = refiner.refine_to_count(200);
    const Clusters fine = refiner.refine_to_count(1500);
    CellStore other = test::cluster_mesh(*context, mesh, 80);
    Refiner direct(*context, other, Priority::Quadric);
    EXPECT_EQ(numbers(direct.refine_to_count(1500)), numbers(fine));
    // Each fine cluster lies in one coarse cluster.
    std::vector<std::uint32_t> parent(fine.size(), 0xffffffffU);
    for (std::uint64_t cell = 0; cell < store.codes.size(); ++cell) {
        std::uint32_t& p = parent[fine.cluster_of_cell[cell]];
        if (p == 0xffffffffU) p = coarse.cluster_of_cell[cell];
        EXPECT_EQ(p, coarse.cluster_of_cell[cell]);
    }
}

TEST(Refiner, ThreadsDoNotShow) {
    const Mesh mesh = test::cube_sphere(110, 0.01);
    std::vector<std::uint32_t> expected;
    std::vector<Vec3> positions;
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        const auto context = test::make_context(n_threads);
        CellStore store = test::cluster_mesh(*context, mesh, 400);
        Refiner refiner(*context, store, Priority::Quadric);
        const Clusters clusters = refiner.refine_to_count(3000);
        if (expected.empty()) {
            expected = numbers(clusters);
            positions.assign(clusters.positions.begin(), clusters.positions.end());
        }
        EXPECT_EQ(numbers(clusters), expected);
        EXPECT_TRUE(std::equal(positions.begin(), positions.end(), clusters.positions.begin()));
    }
}

TEST(Refiner, SurfacesThatAreNotConnectedEndInDifferentClusters) {
    const auto context = test::make_context();
    const auto expect_separate = [&](const Mesh& mesh, double resolution, std::uint64_t n,
                                     const auto& part_of) {
        CellStore store = test::cluster_mesh(*context, mesh, resolution);
        Refiner refiner(*context, store, Priority::Quadric);
        const Clusters clusters = refiner.refine_to_count(n);
        std::vector<std::set<int>> parts(clusters.size());
        for (std::uint64_t cell = 0; cell < store.codes.size(); ++cell) {
            parts[clusters.cluster_of_cell[cell]].insert(
                part_of(store.to_model(store.center(cell))));
        }
        for (const auto& in_cluster : parts) EXPECT_EQ(in_cluster.size(), 1U);
    };
    expect_separate(test::two_sheets(70, 0.04), 60, 300,
                    [](const Vec3& p) { return p[2] < 0.02 ? 0 : 1; });
    expect_separate(test::many_spheres(3, 10), 50, 27 * 15, [](const Vec3& p) {
        return static_cast<int>(std::lround(p[0]) + 3 * std::lround(p[1]) + 9 * std::lround(p[2]));
    });
}

TEST(Refiner, AKeyBoundsTheClusters) {
    const auto context = test::make_context();
    CellStore store = test::cluster_mesh(*context, test::torus(100, 40), 60);
    Refiner refiner(*context, store, Priority::Displacement);
    const Clusters clusters = refiner.refine_to_key(4);
    EXPECT_LT(clusters.size(), store.codes.size());
    for (std::uint64_t cell = 0; cell < store.codes.size(); ++cell) {
        const Vec3 center = store.center(cell) - clusters.origin;
        EXPECT_LE(farthest_corner(center - Vec3{0.5, 0.5, 0.5}, center + Vec3{0.5, 0.5, 0.5},
                                  clusters.positions[clusters.cluster_of_cell[cell]]),
                  4 + 1e-4);
    }
}

TEST(OctreeFusion, MakesAtMostTheClustersAskedFor) {
    const Mesh mesh = test::cube_sphere(50, 0.01);
    for (const unsigned n_threads : {1U, 8U}) {
        const auto context = test::make_context(n_threads);
        const CellStore store = test::cluster_mesh(*context, mesh, 50);
        const std::uint64_t n_cells = store.codes.size();
        for (const std::uint64_t n : {n_cells / 20, n_cells / 4, n_cells / 2, n_cells - 1}) {
            const Clusters clusters = fuse_cells(*context, store, n);
            EXPECT_LE(clusters.size(), n);
            EXPECT_GE(clusters.size(), n - std::min<std::uint64_t>(n, 64));
            expect_all_used(clusters);
            EXPECT_EQ(numbers(clusters), numbers(fuse_cells(*test::make_context(2), store, n)));
        }
        EXPECT_EQ(fuse_cells(*context, store, n_cells).size(), n_cells);
        EXPECT_EQ(fuse_cells(*context, store, 2 * n_cells).size(), n_cells);
    }
}

}  // namespace hewer::rsimp
