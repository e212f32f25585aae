// SPDX-License-Identifier: MIT
#include "rsimp/block_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "block_fixture.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

namespace {

struct Box {
    double key;
    unsigned level;
    std::uint64_t first;
    std::uint64_t last;
    std::uint64_t n_saved;
};

double fused_error(const BlockFixture& fixture, std::uint64_t first, std::uint64_t last) {
    const Vec3 origin = cluster::center_of(fixture.blocks.codes.at(first));
    ClusterSums sums;
    for (std::uint64_t i = first; i < last; ++i) {
        cluster::CellRecord cell = fixture.blocks.cells.at(i);
        const Vec3 shift = cluster::center_of(fixture.blocks.codes.at(i)) - origin;
        for (std::size_t k = 0; k < 3; ++k) cell.mean[k] += static_cast<float>(shift[k]);
        sums.add(cell);
    }
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    return priority(sums, representative(sums, eigen), Priority::Quadric);
}

/// Cells of each cluster, by fusing one box after the other.
std::vector<std::uint32_t> fuse_by_definition(const BlockFixture& fixture, std::uint64_t n_wanted) {
    const auto codes = contents(fixture.blocks.codes);
    std::vector<Box> boxes;
    std::vector<double> inner(codes.size());
    for (unsigned level = 1; level <= kFusionLevels; ++level) {
        for (std::uint64_t first = 0; first < codes.size();) {
            std::uint64_t last = first;
            std::uint64_t n_children = 0;
            double key = 0;
            while (last < codes.size() && codes[last] >> 3 * level == codes[first] >> 3 * level) {
                const auto child = codes[last] >> (3 * level - 3);
                n_children += last == first || child != codes[last - 1] >> (3 * level - 3);
                key = std::max(key, inner[last++]);
            }
            if (n_children > 1) {
                key = std::max(
                    key, fused_error(fixture, first, last) / static_cast<double>(last - first - 1));
                boxes.push_back({key, level, first, last, n_children - 1});
            }
            for (std::uint64_t i = first; i < last; ++i) inner[i] = key;
            first = last;
        }
    }
    std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
        return std::tie(a.key, a.level, a.first) < std::tie(b.key, b.level, b.first);
    });
    std::vector<std::uint64_t> until(codes.size());
    std::uint64_t n = codes.size();
    for (const Box& box : boxes) {
        if (n <= n_wanted) break;
        n -= box.n_saved;
        until[box.first] = std::max(until[box.first], box.last);
    }
    std::vector<std::uint32_t> sizes;
    for (std::uint64_t i = 0; i < codes.size();) {
        const std::uint64_t next = std::max(i + 1, until[i]);
        sizes.push_back(static_cast<std::uint32_t>(next - i));
        i = next;
    }
    return sizes;
}

}  // namespace

TEST(BlockFusion, FusesTheCheapestBoxes) {
    for (const Mesh& mesh : {test::cube_sphere(50, 0.01), test::torus(80, 40)}) {
        // No box that is fused is cut by blocks of 512 cells and more.
        for (const std::uint64_t most_cells : {600U, 1U << 15}) {
            BlockFixture fixture(mesh, 50, most_cells);
            const std::uint64_t n_cells = fixture.blocks.n_cells();
            for (const std::uint64_t n : {n_cells / 20, n_cells / 4, n_cells / 2, n_cells - 1}) {
                const ClusterMesh fused = fuse_blocks(*fixture.context, fixture.blocks, n);
                EXPECT_EQ(contents(fused.n_cells), fuse_by_definition(fixture, n));
                EXPECT_LE(fused.n_clusters(), n);
                EXPECT_GE(fused.n_clusters(), n - std::min<std::uint64_t>(n, 6));
            }
            EXPECT_EQ(fuse_blocks(*fixture.context, fixture.blocks, n_cells).n_clusters(), n_cells);
        }
    }
}

TEST(BlockFusion, EqualKeysAreTakenInTheirOrder) {
    // A plane parallel to the axes: nearly all boxes of a level cost the same.
    BlockFixture fixture(test::cube(40), 40, 1U << 15);
    const std::uint64_t n_cells = fixture.blocks.n_cells();
    for (std::uint64_t n = n_cells - 1; n > n_cells / 16; n -= n_cells / 9) {
        const ClusterMesh fused = fuse_blocks(*fixture.context, fixture.blocks, n);
        EXPECT_LE(fused.n_clusters(), n);
        EXPECT_GE(fused.n_clusters(), n - std::min<std::uint64_t>(n, 6));
    }
}

TEST(BlockFusion, NeitherThreadsNorMemoryShow) {
    const Mesh mesh = test::cube_sphere(80, 0.01);
    std::vector<char> expected;
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        for (const std::uint64_t memory_bytes : {kSmall, kAmple}) {
            BlockFixture fixture(mesh, 80, 700, n_threads, memory_bytes);
            const std::vector<char> found =
                snapshot(fuse_blocks(*fixture.context, fixture.blocks, 5000));
            if (expected.empty()) expected = found;
            EXPECT_TRUE(found == expected) << n_threads << " " << memory_bytes;
        }
    }
}

TEST(BlockFusion, FewerClustersThanBoxesAllowMeansAllBoxes) {
    BlockFixture fixture(test::cube_sphere(50, 0.01), 50, 1U << 15);
    const ClusterMesh fused = fuse_blocks(*fixture.context, fixture.blocks, 1);
    EXPECT_EQ(contents(fused.n_cells), fuse_by_definition(fixture, 1));
    EXPECT_GT(fused.n_clusters(), 1U);
}

}  // namespace hewer::rsimp
