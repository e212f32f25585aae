// SPDX-License-Identifier: MIT
#include "streaming/box_grid.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "streaming/permutation.h"

namespace hewer::streaming {
namespace {

TEST(BoxGrid, IdsAndPointsAreInverse) {
    for (const std::uint64_t n : {12U, 20U, 28U, 48U, 500U, 4000U}) {
        const BoxGrid grid = BoxGrid::for_triangles(n);
        for (std::uint64_t v = 0; v < grid.n_vertices(); ++v) {
            ASSERT_EQ(grid.vertex(grid.point(v)), v) << n;
        }
    }
}

TEST(BoxGrid, QuadsAroundAVertexAreThoseThatHaveIt) {
    const BoxGrid grid = BoxGrid::for_triangles(200);
    using Corners = std::set<std::uint64_t>;
    std::vector<std::multiset<Corners>> expected(grid.n_vertices());
    for (std::uint64_t q = 0; q < grid.n_quads(); ++q) {
        Corners corners;
        for (const auto& p : grid.quad(q)) corners.insert(grid.vertex(p));
        ASSERT_EQ(corners.size(), 4U);
        for (const std::uint64_t v : corners) expected[v].insert(corners);
    }
    for (std::uint64_t v = 0; v < grid.n_vertices(); ++v) {
        std::array<BoxGrid::Quad, 4> quads{};
        const std::size_t n = grid.quads_around(grid.point(v), quads);
        std::multiset<Corners> got;
        for (std::size_t i = 0; i < n; ++i) {
            Corners corners;
            for (const auto& p : quads[i]) corners.insert(grid.vertex(p));
            got.insert(corners);
        }
        ASSERT_EQ(got, expected[v]) << v;
    }
}

TEST(BoxGrid, CountsReachFarBeyond32Bits) {
    const BoxGrid grid = BoxGrid::for_triangles(8'000'000'000);
    EXPECT_LE(2 * grid.n_quads(), 8'000'000'000U);
    EXPECT_GT(2 * grid.n_quads(), 7'999'000'000U);
    EXPECT_EQ(grid.n_vertices(), grid.n_quads() + 2);
    for (const std::uint64_t v : {grid.n_vertices() - 1, grid.n_vertices() / 2}) {
        EXPECT_EQ(grid.vertex(grid.point(v)), v);
    }
}

TEST(Permutation, IsABijectionWithItsInverse) {
    for (const std::uint64_t size : {1U, 2U, 3U, 4U, 5U, 8U, 15U, 16U, 17U, 100U, 1000U, 4097U}) {
        const Permutation order(size, 7);
        std::vector<bool> seen(size);
        for (std::uint64_t i = 0; i < size; ++i) {
            const std::uint64_t p = order(i);
            ASSERT_LT(p, size);
            ASSERT_FALSE(seen[p]);
            seen[p] = true;
            ASSERT_EQ(order.inverse(p), i);
        }
    }
}

TEST(Permutation, WorksBeyond32Bits) {
    const std::uint64_t size = 8'589'934'588;
    const Permutation order(size, 3);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const std::uint64_t at = i * (size / 1000);
        ASSERT_LT(order(at), size);
        ASSERT_EQ(order.inverse(order(at)), at);
    }
}

}  // namespace
}  // namespace hewer::streaming
