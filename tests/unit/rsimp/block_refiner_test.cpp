// SPDX-License-Identifier: MIT
#include "rsimp/block_refiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "block_fixture.h"
#include "rsimp/block_tree.h"
#include "rsimp/cluster_mesh_builder.h"
#include "rsimp/key_selection.h"

namespace hewer::rsimp {

namespace {

/// As defined: all trees grown to the end, and the cut at the n-th largest key of all.
ClusterMesh refine_by_definition(BlockFixture& fixture, std::uint64_t n_clusters) {
    const std::size_t n_blocks = fixture.blocks.n_blocks();
    std::vector<BlockCut> cuts(n_blocks);
    std::vector<double> keys;
    BlockTree tree;
    for (std::size_t b = 0; b < n_blocks; ++b) {
        tree.grow_to_key(fixture.blocks, b, Priority::Quadric, 0, cuts[b]);
        keys.insert(keys.end(), cuts[b].keys.begin(), cuts[b].keys.end());
    }
    std::sort(keys.begin(), keys.end(), std::greater<>());
    const double threshold = keys.at(n_clusters - n_blocks);
    return build_cluster_mesh(*fixture.context, fixture.blocks,
                              [&](std::size_t b, CellGroups& groups) {
                                  groups.order = cuts[b].order;
                                  groups.begins.push_back(0);
                                  for (std::size_t i = 0; i < cuts[b].keys.size(); ++i) {
                                      if (cuts[b].keys[i] <= threshold) continue;
                                      groups.begins.push_back(cuts[b].begins[i]);
                                  }
                              });
}

ClusterMesh refine(BlockFixture& fixture, std::uint64_t n_clusters) {
    return BlockRefiner(*fixture.context, fixture.blocks, Priority::Quadric)
        .refine_to_count(n_clusters);
}

std::uint64_t sum(const std::vector<std::uint32_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

}  // namespace

TEST(KeyAtWeight, IsTheKeyThatASortedListHasThere) {
    const auto context = test::make_context();
    test::Random random(3);
    struct Record {
        double key;
        std::uint64_t weight;
    };
    std::vector<Record> records;
    for (int i = 0; i < 5000; ++i) {
        // Of all sizes, many of them equal, some infinite.
        const double key = i % 50 == 0 ? std::numeric_limits<double>::infinity()
                                       : std::ldexp(static_cast<double>(random.below(40)),
                                                    static_cast<int>(random.below(60)) - 30);
        records.push_back({key, 1 + random.below(5)});
    }
    ooc::Spool<Record> spool(*context, "records");
    spool.append(records);
    std::sort(records.begin(), records.end(),
              [](const Record& a, const Record& b) { return a.key < b.key; });
    std::uint64_t weight = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        weight += records[i].weight;
        if (i % 100 != 0 && i + 1 != records.size()) continue;
        EXPECT_EQ(key_at_weight(
                      *context, spool, weight, [](const Record& r) { return r.key; },
                      [](const Record& r) { return r.weight; }),
                  records[i].key);
    }
}

TEST(BlockRefiner, MakesTheCutThatIsDefined) {
    for (const Mesh& mesh : {test::cube_sphere(60, 0.02), test::two_sheets(60, 0.04),
                             test::joined(test::plane_grid(60), test::cube_sphere(30, 0.05)),
                             test::random_soup(2000, 3000, 5)}) {
        for (const std::uint64_t most_cells : {60U, 700U, 1U << 15}) {
            BlockFixture fixture(mesh, 60, most_cells);
            const std::uint64_t n_blocks = fixture.blocks.n_blocks();
            const std::uint64_t n_cells = fixture.blocks.n_cells();
            for (const double share : {0.001, 0.2, 0.7, 0.999}) {
                const auto n = n_blocks + static_cast<std::uint64_t>(
                                              share * static_cast<double>(n_cells - n_blocks));
                EXPECT_TRUE(snapshot(refine(fixture, n)) ==
                            snapshot(refine_by_definition(fixture, n)))
                    << most_cells << " " << n;
            }
        }
    }
}

TEST(BlockRefiner, MakesAsManyClustersAsAskedFor) {
    for (const double resolution : {60.0, 200.0}) {
        for (const std::uint64_t most_cells : {500U, 1U << 15}) {
            BlockFixture fixture(test::cube_sphere(110, 0.01), resolution, most_cells);
            const std::uint64_t n_cells = fixture.blocks.n_cells();
            for (const std::uint64_t n : {400U, 1000U, 4000U}) {
                const ClusterMesh mesh = refine(fixture, n);
                const std::uint64_t most = std::clamp(n, fixture.blocks.n_blocks(), n_cells);
                EXPECT_LE(mesh.n_clusters(), most);
                EXPECT_GE(mesh.n_clusters(), most - 2);  // a child may inherit its parent's key
                EXPECT_EQ(sum(contents(mesh.n_cells)), n_cells);
            }
            EXPECT_EQ(refine(fixture, n_cells).n_clusters(), n_cells);
            EXPECT_EQ(refine(fixture, 2 * n_cells).n_clusters(), n_cells);
            EXPECT_EQ(refine(fixture, 1).n_clusters(), fixture.blocks.n_blocks());
        }
    }
}

TEST(BlockRefiner, AsksForMoreOfTheSameTrees) {
    BlockFixture fixture(test::cube_sphere(60, 0.02), 80, 1000);
    BlockRefiner refiner(*fixture.context, fixture.blocks, Priority::Quadric);
    for (const std::uint64_t n : {200U, 1500U, 4000U, 300U}) {
        EXPECT_TRUE(snapshot(refiner.refine_to_count(n)) == snapshot(refine(fixture, n))) << n;
    }
}

TEST(BlockRefiner, NeitherThreadsNorMemoryShow) {
    const Mesh mesh = test::cube_sphere(110, 0.01);
    for (const std::uint64_t most_cells : {400U, 1U << 15}) {
        std::vector<char> expected;
        for (const unsigned n_threads : {1U, 2U, 8U}) {
            for (const std::uint64_t memory_bytes : {kSmall, kAmple}) {
                BlockFixture fixture(mesh, 200, most_cells, n_threads, memory_bytes);
                fixture.add_attributes();
                const std::vector<char> found = snapshot(refine(fixture, 3000));
                if (expected.empty()) expected = found;
                EXPECT_TRUE(found == expected) << n_threads << " " << memory_bytes;
            }
        }
    }
}

TEST(BlockRefiner, SurfacesThatAreNotConnectedEndInDifferentClusters) {
    const double gap = 0.04;
    BlockFixture fixture(test::two_sheets(70, gap), 60, 1000);
    const ClusterMesh mesh = refine(fixture, 300);
    const double cell = fixture.blocks.grid.cell_size(fixture.blocks.lattice);
    for (const CollapseVertex& vertex : contents(mesh.vertices)) {
        const double height =
            static_cast<double>(vertex.box[5]) - static_cast<double>(vertex.box[2]);
        EXPECT_LT(height, gap / cell + 0.5);
    }
}

TEST(BlockRefiner, AKeyBoundsTheClusters) {
    constexpr double kCellDiagonal = 1.7321;
    for (const std::uint64_t most_cells : {500U, 1U << 15}) {
        BlockFixture fixture(test::torus(100, 40), 60, most_cells);
        BlockRefiner refiner(*fixture.context, fixture.blocks, Priority::Displacement);
        for (const double key : {4.0, 2.0, 0.0, 3.0}) {
            const ClusterMesh mesh = refiner.refine_to_key(key);
            EXPECT_EQ(mesh.n_clusters() < fixture.blocks.n_cells(), key > 1);
            for (const CollapseVertex& v : contents(mesh.vertices)) {
                const Vec3 low{v.box[0], v.box[1], v.box[2]};
                const Vec3 high{v.box[3], v.box[4], v.box[5]};
                EXPECT_LE(farthest_corner(low, high, v.position),
                          std::max(key, kCellDiagonal) + 1e-4);
            }
        }
    }
}

TEST(ClusterMeshBuilder, GroupsBecomeClustersAndFacesFollow) {
    const Mesh mesh = test::cube_sphere(50, 0.02);
    BlockFixture fixture(mesh, 50, 300);
    fixture.add_attributes();
    const cluster::CellBlocks& blocks = fixture.blocks;
    ASSERT_GT(blocks.n_blocks(), 10U);
    const auto codes = contents(blocks.codes);
    const auto cells = contents(blocks.cells);
    const auto attributes = contents(blocks.attributes);

    // Every k-th cell of a block, from the last to the first.
    constexpr std::uint64_t kStride = 5;
    std::vector<std::uint32_t> cluster_of_cell(blocks.n_cells());
    std::vector<CellGroups> all_groups(blocks.n_blocks());
    std::uint32_t n_clusters = 0;
    for (std::size_t b = 0; b < blocks.n_blocks(); ++b) {
        for (std::uint64_t k = 0; k < std::min(kStride, fixture.n_cells_of(b)); ++k) {
            all_groups[b].begins.push_back(static_cast<LocalCell>(all_groups[b].order.size()));
            for (std::uint64_t i = fixture.n_cells_of(b); i-- > 0;) {
                if (i % kStride != k) continue;
                all_groups[b].order.push_back(static_cast<LocalCell>(i));
                cluster_of_cell[blocks.blocks[b].first_cell + i] = n_clusters;
            }
            ++n_clusters;
        }
    }
    const ClusterMesh result =
        build_cluster_mesh(*fixture.context, blocks,
                           [&](std::size_t b, CellGroups& groups) { groups = all_groups[b]; });

    EXPECT_TRUE(result.is_closed);
    ASSERT_EQ(result.n_clusters(), n_clusters);
    ASSERT_EQ(result.n_blocks(), blocks.n_blocks());
    EXPECT_EQ(result.blocks.back().first_cluster, n_clusters);
    EXPECT_EQ(result.blocks.back().first_face, result.faces.size());

    const auto vertices = contents(result.vertices);
    std::vector<ClusterSums> sums(n_clusters);
    std::vector<std::uint32_t> n_cells(n_clusters);
    std::vector<float> red(n_clusters);
    // Sums want a cell's centre for their origin; the mesh's is a cell's corner.
    const Vec3 half{0.5, 0.5, 0.5};
    for (std::uint64_t i = 0; i < codes.size(); ++i) {
        cluster::CellRecord cell = cells[i];
        const Vec3 center = cluster::center_of(codes[i]) - (result.origin + half);
        for (std::size_t k = 0; k < 3; ++k) cell.mean[k] += static_cast<float>(center[k]);
        sums[cluster_of_cell[i]].add(cell);
        ++n_cells[cluster_of_cell[i]];
        red[cluster_of_cell[i]] += attributes[i].color[0];
    }
    EXPECT_EQ(contents(result.n_cells), n_cells);
    const auto result_attributes = contents(result.attributes.sums);
    for (std::uint32_t c = 0; c < n_clusters; ++c) {
        EXPECT_EQ(result_attributes[c].color[0], red[c]);
        const Vec3 expected =
            representative(sums[c], cluster::eigen_decomposition(sums[c].quadric.a));
        const CollapseVertex& vertex = vertices[c];
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(vertex.position[k], expected[k] + 0.5, 1e-2);
            const double low = sums[c].low[k] + 0.5;
            const double high = sums[c].high[k] + 0.5;
            EXPECT_LE(static_cast<double>(vertex.box[k]), low);
            EXPECT_GE(static_cast<double>(vertex.box[k]), low - 1e-4);
            EXPECT_GE(static_cast<double>(vertex.box[3 + k]), high);
            EXPECT_LE(static_cast<double>(vertex.box[3 + k]), high + 1e-4);
        }
        EXPECT_NEAR(vertex.quadric.trace(), sums[c].quadric.trace(), 1e-6);
        EXPECT_NEAR(vertex.quadric.error(expected + half), sums[c].quadric.error(expected), 1e-2);
    }

    for (std::size_t b = 0; b < blocks.n_blocks(); ++b) {
        const auto& first = blocks.blocks[b];
        EXPECT_EQ(result.blocks[b].box.code, first.box.code);
        EXPECT_EQ(result.blocks[b].first_cluster, cluster_of_cell[first.first_cell]);
        std::vector<CellTriple> faces(blocks.blocks[b + 1].first_face - first.first_face);
        blocks.faces.read(first.first_face, std::span(faces));
        std::vector<CellTriple> expected;
        for (const CellTriple& face : faces) {
            const CellTriple t{cluster_of_cell[face[0]], cluster_of_cell[face[1]],
                               cluster_of_cell[face[2]]};
            if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) expected.push_back(t);
        }
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(sorted_faces(result, b), expected);
    }
}

TEST(ClusterMeshBuilder, CellsAsClustersKeepTheirIds) {
    BlockFixture fixture(test::plane_grid(40, 0.01), 30, 200);
    const ClusterMesh mesh = cells_as_clusters(*fixture.context, fixture.blocks);
    EXPECT_EQ(contents(mesh.faces), contents(fixture.blocks.faces));
    EXPECT_EQ(sum(contents(mesh.n_cells)), mesh.n_clusters());
    EXPECT_FALSE(mesh.is_closed);
    const auto codes = contents(fixture.blocks.codes);
    const auto vertices = contents(mesh.vertices);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const Vec3 center = cluster::center_of(codes[i]) - mesh.origin;
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LE(std::fabs(vertices[i].position[k] - center[k]), 0.5);
        }
    }
}

TEST(ClusterMeshBuilder, NoCellsMakeNoClusters) {
    const auto context = test::make_context();
    cluster::CellBlocks blocks;
    blocks.blocks.emplace_back();
    EXPECT_EQ(cells_as_clusters(*context, blocks).n_clusters(), 0U);
    BlockRefiner refiner(*context, blocks, Priority::Quadric);
    EXPECT_EQ(refiner.refine_to_count(10).n_clusters(), 0U);
    EXPECT_EQ(refiner.refine_to_key(1).n_clusters(), 0U);
}

}  // namespace hewer::rsimp
