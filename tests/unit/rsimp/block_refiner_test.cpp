// SPDX-License-Identifier: MIT
/// Cluster trees, cuts, and the fusion of the uniform method.
#include "rsimp/block_refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <vector>

#include "rsimp/cluster_tree.h"
#include "rsimp/octree_fusion.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;

constexpr std::uint64_t kOneBlock = std::uint64_t{1} << 40;

/// One tree over all cells of a mesh.
struct WholeTree {
    WholeTree(const Mesh& mesh, double resolution, Priority priority = Priority::Quadric)
        : context(test::make_context()),
          tree(load_block(test::cluster_mesh(*context, mesh, resolution, 1, kOneBlock), 0),
               priority) {}
    /// The clusters of a cut as sets of cell ids.
    [[nodiscard]] std::set<std::set<std::uint32_t>> cut(double threshold) const {
        std::set<std::set<std::uint32_t>> clusters;
        tree.for_each_cluster(threshold, [&](const ClusterNode& node) {
            std::set<std::uint32_t> ids;
            for (std::uint32_t i = node.cell_begin; i < node.cell_end; ++i) {
                ids.insert(tree.block().cells[i].id);
            }
            clusters.insert(ids);
        });
        return clusters;
    }

    std::unique_ptr<ooc::Context> context;
    ClusterTree tree;
};

std::multiset<cluster::CellTriple> faces_of(const CellBlock& block) {
    return {block.faces.begin(), block.faces.end()};
}

/// A cluster mesh in memory, with the cluster of each cell found again from boxes and places.
struct Made {
    explicit Made(const ClusterMesh& mesh)
        : vertices(test::read_all(mesh.vertices)),
          n_cells(test::read_all(mesh.n_cells)),
          faces(test::read_all(mesh.faces)),
          origin(mesh.origin) {
        std::sort(faces.begin(), faces.end());  // their order means nothing
    }
    [[nodiscard]] std::uint64_t size() const { return vertices.size(); }
    bool operator==(const Made& other) const {
        return faces == other.faces && n_cells == other.n_cells &&
               std::equal(vertices.begin(), vertices.end(), other.vertices.begin(),
                          other.vertices.end(), [](const auto& a, const auto& b) {
                              return a.position == b.position && a.box == b.box &&
                                     a.quadric.a == b.quadric.a && a.quadric.b == b.quadric.b &&
                                     a.quadric.c == b.quadric.c;
                          });
    }

    std::vector<CollapseVertex> vertices;
    std::vector<std::uint32_t> n_cells;
    std::vector<CellTriple> faces;
    Vec3 origin;
};

void expect_all_used(const Made& clusters, const CellBlocks& cells) {
    std::uint64_t n = 0;
    for (const std::uint32_t k : clusters.n_cells) {
        EXPECT_GT(k, 0U);
        n += k;
    }
    EXPECT_EQ(n, cells.n_cells());
    for (const CellTriple& face : clusters.faces) {
        for (const std::uint32_t c : face) EXPECT_LT(c, clusters.size());
    }
}

}  // namespace

TEST(ClusterTree, SubrangesAreDisjointCoveringAndNested) {
    for (const Mesh& mesh : {test::cube_sphere(25, 0.03), test::two_sheets(30, 0.05),
                             test::many_spheres(2, 8), test::random_soup(300, 900, 2)}) {
        WholeTree whole(mesh, 30);
        const CellBlock& block = whole.tree.block();
        const auto faces_before = faces_of(block);
        whole.tree.grow(0);
        EXPECT_EQ(faces_of(block), faces_before);
        const auto& nodes = whole.tree.nodes();
        EXPECT_EQ(nodes[0].cell_begin, 0U);
        EXPECT_EQ(nodes[0].cell_end, block.cells.size());
        for (const ClusterNode& node : nodes) {
            // Exactly the faces of the subrange have two corners or more in the cluster.
            for (std::uint32_t f = 0; f < block.faces.size(); f += 7) {
                std::uint32_t inside = 0;
                for (const std::uint32_t id : block.faces[f]) {
                    const std::uint32_t at = whole.tree.place_of_id()[id];
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
        for (std::uint32_t i = 0; i < block.cells.size(); ++i) {
            EXPECT_EQ(whole.tree.place_of_id()[block.cells[i].id], i);
        }
    }
}

TEST(ClusterTree, GrowingInStepsGivesTheSameCuts) {
    const Mesh mesh = test::cube_sphere(25, 0.03);
    WholeTree at_once(mesh, 30);
    at_once.tree.grow(0.01);
    WholeTree in_steps(mesh, 30);
    for (const double threshold : {100.0, 5.0, 1.0, 0.2, 0.01}) in_steps.tree.grow(threshold);
    for (const double threshold : {50.0, 1.0, 0.05, 0.01}) {
        EXPECT_EQ(at_once.cut(threshold), in_steps.cut(threshold));
    }
    EXPECT_GT(at_once.cut(0.01).size(), at_once.cut(1).size());
}

TEST(ClusterTree, EveryPriorityIsMonotone) {
    for (const Priority priority : {Priority::Quadric, Priority::Displacement}) {
        WholeTree whole(test::torus(60, 30), 40, priority);
        whole.tree.grow(0.1);
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

TEST(BlockRefiner, MakesAsManyClustersAsAskedOfOneBlockOrMany) {
    const auto context = test::make_context();
    for (const std::uint64_t block : {100U, 3000U, 1000000U}) {
        const CellBlocks cells =
            test::cluster_mesh(*context, test::cube_sphere(60, 0.01), 100, 1, block);
        for (const std::uint64_t n : {500U, 1000U, 4000U}) {
            if (n < cells.n_blocks()) continue;
            const Made clusters(
                BlockRefiner(*context, cells, Priority::Quadric).refine_to_count(n));
            EXPECT_LE(clusters.size(), n);
            EXPECT_GE(clusters.size(), n - 2);
            expect_all_used(clusters, cells);
        }
        const Made all(BlockRefiner(*context, cells, Priority::Quadric).refine_to_count(10000000));
        EXPECT_EQ(all.size(), cells.n_cells());
    }
}

TEST(BlockRefiner, WhatWasGrownBeforeDoesNotShow) {
    const auto context = test::make_context();
    const CellBlocks cells = test::cluster_mesh(*context, test::cube_sphere(60, 0.02), 80, 1, 1000);
    BlockRefiner refiner(*context, cells, Priority::Quadric);
    const Made coarse(refiner.refine_to_count(200));
    const Made fine(refiner.refine_to_count(1500));
    EXPECT_GT(fine.size(), coarse.size());
    EXPECT_EQ(Made(refiner.refine_to_count(200)), coarse);
    EXPECT_EQ(Made(BlockRefiner(*context, cells, Priority::Quadric).refine_to_count(1500)), fine);
}

TEST(BlockRefiner, NeitherThreadsNorMemoryShow) {
    const Mesh mesh = test::cube_sphere(60, 0.01);
    std::optional<Made> expected;
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        for (const std::uint64_t mib : {4096U, 28U}) {  // with little, no tree is kept
            ooc::Context context({.memory_bytes = mib << 20, .n_threads = n_threads});
            const CellBlocks cells = test::cluster_mesh(context, mesh, 100, 1, 2000);
            Made clusters(BlockRefiner(context, cells, Priority::Quadric).refine_to_count(3000));
            if (!expected) expected = clusters;
            EXPECT_EQ(clusters, *expected) << n_threads << ' ' << mib;
        }
    }
}

TEST(BlockRefiner, SurfacesThatAreNotConnectedEndInDifferentClusters) {
    const auto context = test::make_context();
    // Faces tell: clusters of one surface are joined by faces, of two never.
    const auto count_parts = [&](const Mesh& mesh, double resolution, std::uint64_t n) {
        const CellBlocks cells = test::cluster_mesh(*context, mesh, resolution, 1, 500);
        const Made made(BlockRefiner(*context, cells, Priority::Quadric).refine_to_count(n));
        std::vector<std::uint32_t> label(made.size());
        std::iota(label.begin(), label.end(), 0U);
        const auto find = [&](std::uint32_t v) {
            while (label[v] != v) v = label[v];
            return v;
        };
        for (const CellTriple& t : made.faces) {
            label[find(t[1])] = find(t[0]);
            label[find(t[2])] = find(t[0]);
        }
        std::set<std::uint32_t> parts;
        for (const CellTriple& t : made.faces) parts.insert(find(t[0]));
        return parts.size();
    };
    EXPECT_EQ(count_parts(test::two_sheets(70, 0.04), 60, 300), 2U);
    EXPECT_EQ(count_parts(test::many_spheres(3, 10), 50, 27 * 15), 27U);
}

TEST(BlockRefiner, AKeyBoundsTheClusters) {
    const auto context = test::make_context();
    const CellBlocks cells = test::cluster_mesh(*context, test::torus(100, 40), 60, 1, 700);
    const Made clusters(BlockRefiner(*context, cells, Priority::Displacement).refine_to_key(4));
    EXPECT_LT(clusters.size(), cells.n_cells());
    expect_all_used(clusters, cells);
    for (const CollapseVertex& v : clusters.vertices) {
        EXPECT_LE(farthest_corner({v.box[0], v.box[1], v.box[2]}, {v.box[3], v.box[4], v.box[5]},
                                  v.position),
                  4 + 1e-4);
    }
}

TEST(CellsAsClusters, KeepsEverything) {
    const auto context = test::make_context();
    const CellBlocks cells = test::cluster_mesh(*context, test::cube_sphere(30, 0.01), 30, 1, 300);
    const Made clusters(cells_as_clusters(*context, cells));
    EXPECT_EQ(clusters.size(), cells.n_cells());
    auto faces = test::read_all(cells.faces);
    std::sort(faces.begin(), faces.end());
    EXPECT_EQ(clusters.faces, faces);
}

TEST(OctreeFusion, MakesAtMostTheClustersAskedFor) {
    const Mesh mesh = test::cube_sphere(50, 0.01);
    for (const unsigned n_threads : {1U, 8U}) {
        const auto context = test::make_context(n_threads);
        const CellBlocks cells = test::cluster_mesh(*context, mesh, 50, 1, 2000);
        const std::uint64_t n_cells = cells.n_cells();
        for (const std::uint64_t n : {n_cells / 20, n_cells / 4, n_cells / 2, n_cells - 1}) {
            const Made clusters(fuse_blocks(*context, cells, n));
            EXPECT_LE(clusters.size(), n);
            EXPECT_GE(clusters.size(), n - std::min<std::uint64_t>(n, 64));
            expect_all_used(clusters, cells);
            EXPECT_EQ(clusters, Made(fuse_blocks(*test::make_context(2), cells, n)));
        }
        EXPECT_EQ(Made(fuse_blocks(*context, cells, n_cells)).size(), n_cells);
        EXPECT_EQ(Made(fuse_blocks(*context, cells, 2 * n_cells)).size(), n_cells);
    }
}

}  // namespace hewer::rsimp
