// SPDX-License-Identifier: MIT
#include "rsimp/block_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "block_fixture.h"

namespace hewer::rsimp {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

BlockCut cut_at(const BlockFixture& fixture, std::size_t block, double threshold,
                Priority priority = Priority::Quadric) {
    BlockTree tree;
    BlockCut cut;
    tree.grow_to_key(fixture.blocks, block, priority, threshold, cut);
    return cut;
}

/// The clusters of the cut at `threshold`, as sets of cells.
std::set<std::set<LocalCell>> clusters_of(const BlockCut& cut, double threshold) {
    std::set<std::set<LocalCell>> clusters;
    std::set<LocalCell> cluster;
    std::size_t next = 0;
    for (std::size_t i = 0; i < cut.order.size(); ++i) {
        if (next < cut.begins.size() && cut.begins[next] == i) {
            if (cut.keys[next] > threshold) clusters.insert(std::exchange(cluster, {}));
            ++next;
        }
        cluster.insert(cut.order[i]);
    }
    clusters.insert(cluster);
    return clusters;
}

std::vector<Mesh> meshes() {
    return {test::cube_sphere(25, 0.03), test::two_sheets(30, 0.05), test::many_spheres(2, 8),
            test::random_soup(300, 900, 2)};
}

}  // namespace

TEST(CellGraph, JoinsTheCellsOfEveryFaceInTheListOfTheBlock) {
    for (const Mesh& mesh : meshes()) {
        const BlockFixture fixture(mesh, 30, 100);
        ASSERT_GT(fixture.blocks.n_blocks(), 1U);
        CellGraph graph;
        for (std::size_t b = 0; b < fixture.blocks.n_blocks(); ++b) {
            const auto& block = fixture.blocks.blocks[b];
            const std::uint64_t n = fixture.n_cells_of(b);
            std::set<std::pair<std::uint64_t, std::uint64_t>> expected;
            std::set<std::uint64_t> with_face;
            std::vector<CellTriple> faces(fixture.blocks.blocks[b + 1].first_face -
                                          block.first_face);
            fixture.blocks.faces.read(block.first_face, std::span(faces));
            for (const CellTriple& face : faces) {
                for (const std::uint32_t p : face) {
                    if (p < block.first_cell || p >= block.first_cell + n) continue;
                    with_face.insert(p - block.first_cell);
                    for (const std::uint32_t q : face) {
                        if (p < q && q < block.first_cell + n) {
                            expected.insert({p - block.first_cell, q - block.first_cell});
                        }
                    }
                }
            }
            graph.load(fixture.blocks, b);
            std::set<std::pair<std::uint64_t, std::uint64_t>> found;
            std::uint64_t n_found = 0;
            for (std::uint64_t i = 0; i < n; ++i) {
                const auto cell = static_cast<LocalCell>(i);
                EXPECT_EQ(graph.has_face(cell), with_face.contains(i));
                for (const LocalCell j : graph.later_neighbours(cell)) found.insert({i, j});
                n_found += graph.later_neighbours(cell).size();
            }
            EXPECT_EQ(found, expected);
            EXPECT_EQ(n_found, expected.size());
        }
    }
}

TEST(BlockTree, CutsHoldEveryCellOnceAndKeysAboveTheirThreshold) {
    for (const Mesh& mesh : meshes()) {
        const BlockFixture fixture(mesh, 30, 2000);
        for (std::size_t b = 0; b < fixture.blocks.n_blocks(); ++b) {
            for (const double threshold : {kInfinity, 1.0, 0.01, 0.0}) {
                const BlockCut cut = cut_at(fixture, b, threshold);
                const std::set<LocalCell> cells(cut.order.begin(), cut.order.end());
                EXPECT_EQ(cut.order.size(), fixture.n_cells_of(b));
                EXPECT_EQ(cells.size(), cut.order.size());
                EXPECT_EQ(*cells.rbegin() + 1U, cells.size());
                EXPECT_EQ(cut.keys.size(), cut.begins.size());
                EXPECT_TRUE(std::adjacent_find(cut.begins.begin(), cut.begins.end(),
                                               std::greater_equal<>()) == cut.begins.end());
                for (const double key : cut.keys) EXPECT_GT(key, threshold);
                EXPECT_EQ(cut.threshold, threshold);
                EXPECT_TRUE(threshold != kInfinity || cut.begins.empty());
            }
        }
    }
}

TEST(BlockTree, AFineCutHoldsEveryCoarserOne) {
    for (const Mesh& mesh : meshes()) {
        const BlockFixture fixture(mesh, 30, 2000);
        const BlockCut finest = cut_at(fixture, 0, 0);
        EXPECT_EQ(clusters_of(finest, 0).size(), finest.order.size());
        for (const double threshold : {kInfinity, 50.0, 1.0, 0.05, 0.001}) {
            EXPECT_EQ(clusters_of(finest, threshold),
                      clusters_of(cut_at(fixture, 0, threshold), threshold));
        }
    }
}

TEST(BlockTree, GrowingInStepsGivesTheSameCut) {
    for (const Priority priority :
         {Priority::Quadric, Priority::Displacement, Priority::NormalVariation}) {
        BlockFixture fixture(test::cube_sphere(25, 0.03), 30, 2000);
        fixture.add_attributes();
        BlockTree tree;
        BlockCut in_steps;
        for (const double threshold : {100.0, 5.0, 1.0, 0.2, 0.01}) {
            tree.grow_to_key(fixture.blocks, 0, priority, threshold, in_steps);
        }
        const BlockCut at_once = cut_at(fixture, 0, 0.01, priority);
        EXPECT_EQ(at_once.order, in_steps.order);
        EXPECT_EQ(at_once.begins, in_steps.begins);
        EXPECT_EQ(at_once.keys, in_steps.keys);
    }
}

TEST(BlockTree, SplittingTheWorstFirstGivesTheCutAtTheKeyThatIsNext) {
    const BlockFixture fixture(test::cube_sphere(25, 0.03), 30, 2000);
    BlockTree tree;
    std::vector<double> keys = cut_at(fixture, 0, 0).keys;
    std::sort(keys.begin(), keys.end(), std::greater<>());
    for (const std::uint64_t n : {0U, 1U, 7U, 200U}) {
        BlockCut cut;
        tree.grow_by_splits(fixture.blocks, 0, Priority::Quadric, n, cut);
        EXPECT_EQ(cut.keys.size(), n);
        EXPECT_EQ(cut.threshold, keys[n]);
        EXPECT_EQ(clusters_of(cut, cut.threshold),
                  clusters_of(cut_at(fixture, 0, cut.threshold), cut.threshold));
    }
    BlockCut all;
    tree.grow_by_splits(fixture.blocks, 0, Priority::Quadric, 1U << 20, all);
    EXPECT_EQ(all.keys.size(), keys.size());
    EXPECT_EQ(all.threshold, 0);
}

TEST(BlockTree, SmallClustersAreConnected) {
    for (const Mesh& mesh : {test::two_sheets(70, 0.04), test::many_spheres(3, 10)}) {
        const BlockFixture fixture(mesh, 55, 4000);
        CellGraph graph;
        for (std::size_t b = 0; b < fixture.blocks.n_blocks(); ++b) {
            graph.load(fixture.blocks, b);
            for (const auto& cluster : clusters_of(cut_at(fixture, b, 0.001), 0.001)) {
                if (cluster.size() > 128) continue;
                // Cells without a face go with any other.
                std::set<LocalCell> reached;
                std::vector<LocalCell> open;
                for (const LocalCell cell : cluster) {
                    if (graph.has_face(cell) && !open.empty()) continue;
                    open.push_back(cell);
                }
                while (!open.empty()) {
                    const LocalCell cell = open.back();
                    open.pop_back();
                    if (!reached.insert(cell).second) continue;
                    for (const LocalCell other : cluster) {
                        const auto from = graph.later_neighbours(std::min(cell, other));
                        if (std::count(from.begin(), from.end(), std::max(cell, other)) > 0) {
                            open.push_back(other);
                        }
                    }
                }
                EXPECT_EQ(reached.size(), cluster.size());
            }
        }
    }
}

}  // namespace hewer::rsimp
