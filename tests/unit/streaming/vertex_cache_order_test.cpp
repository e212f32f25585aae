// SPDX-License-Identifier: MIT
#include "streaming/vertex_cache_order.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <random>
#include <vector>

#include "hewer/error.h"

namespace hewer::streaming {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// 2 n n triangles on (n+1) x (n+1) vertices, triangles and vertex ids in random order.
std::vector<Corners> shuffled_grid(std::uint32_t n) {
    std::mt19937_64 random(7);
    std::vector<std::uint32_t> id((n + 1) * (n + 1));
    for (std::uint32_t i = 0; i < id.size(); ++i) id[i] = i;
    std::shuffle(id.begin(), id.end(), random);
    std::vector<Corners> triangles;
    for (std::uint32_t j = 0; j < n; ++j) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
            triangles.push_back({id[a], id[a + 1], id[b]});
            triangles.push_back({id[a + 1], id[b + 1], id[b]});
        }
    }
    std::shuffle(triangles.begin(), triangles.end(), random);
    return triangles;
}

/// Average cache miss ratio: vertices transformed per triangle with a first-in-first-out cache
/// of 16.
double acmr(const std::vector<Corners>& triangles) {
    std::deque<std::uint32_t> cache;
    std::uint64_t misses = 0;
    for (const Corners& t : triangles) {
        for (const std::uint32_t v : t) {
            if (std::find(cache.begin(), cache.end(), v) != cache.end()) continue;
            ++misses;
            cache.push_back(v);
            if (cache.size() > 16) cache.pop_front();
        }
    }
    return static_cast<double>(misses) / static_cast<double>(triangles.size());
}

// What meshoptimizer holds and held at most, counted through its allocator.
std::size_t g_held = 0;
std::size_t g_peak = 0;

void* counting_allocate(std::size_t bytes) {
    auto* const block = static_cast<std::max_align_t*>(
        std::malloc(bytes + sizeof(std::max_align_t)));  // the size goes in front
    *reinterpret_cast<std::size_t*>(block) = bytes;
    g_held += bytes;
    g_peak = std::max(g_peak, g_held);
    return block + 1;
}

void counting_free(void* address) {
    if (address == nullptr) return;
    auto* const block = static_cast<std::max_align_t*>(address) - 1;
    g_held -= *reinterpret_cast<std::size_t*>(block);
    std::free(block);
}

Corners rotated_to_smallest(Corners t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

TEST(VertexCacheOrder, BringsAShuffledGridNearTheBestRatio) {
    std::vector<Corners> triangles = shuffled_grid(100);
    const double before = acmr(triangles);
    order_for_vertex_cache(triangles, 101 * 101);
    EXPECT_GT(before, 2.9);
    EXPECT_LT(acmr(triangles), 0.75);  // 0.5 with a cache without end
}

TEST(VertexCacheOrder, KeepsTheTrianglesAndTheirWinding) {
    std::vector<Corners> before = shuffled_grid(30);
    std::vector<Corners> after = before;
    order_for_vertex_cache(after, 31 * 31);
    EXPECT_NE(before, after);
    for (Corners& t : before) t = rotated_to_smallest(t);
    for (Corners& t : after) t = rotated_to_smallest(t);
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after);
}

TEST(VertexCacheOrder, IsTheSameEveryTime) {
    std::vector<Corners> a = shuffled_grid(50), b = a;
    order_for_vertex_cache(a, 51 * 51);
    order_for_vertex_cache(b, 51 * 51);
    EXPECT_EQ(a, b);
}

TEST(VertexCacheOrder, HoldsWhatItSays) {
    std::vector<Corners> triangles = shuffled_grid(100);
    meshopt_setAllocator(counting_allocate, counting_free);
    order_for_vertex_cache(triangles, 101 * 101);
    meshopt_setAllocator(std::malloc, std::free);
    const std::uint64_t claimed = vertex_cache_order_bytes(triangles.size(), 101 * 101);
    EXPECT_LE(g_peak, claimed);
    EXPECT_GT(g_peak, claimed * 9 / 10);
}

TEST(VertexCacheOrder, TakesAMeshWithoutTriangles) {
    order_for_vertex_cache({}, 3);
    order_for_vertex_cache({}, 0);
}

TEST(VertexCacheOrder, RefusesCornersOutOfRange) {
    std::vector<Corners> triangles{{0, 1, 3}};
    EXPECT_THROW(order_for_vertex_cache(triangles, 3), InternalError);
}

}  // namespace
}  // namespace hewer::streaming
