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
    std::vector<std::uint32_t> place(101 * 101);
    const double before = acmr(triangles);
    order_for_vertex_cache(triangles, place.size(), place);
    EXPECT_GT(before, 2.9);
    EXPECT_LT(acmr(triangles), 0.75);  // 0.5 with a cache without end
}

TEST(VertexCacheOrder, KeepsTheTrianglesAndTheirWinding) {
    std::vector<Corners> before = shuffled_grid(30);
    std::vector<Corners> after = before;
    std::vector<std::uint32_t> place(31 * 31);
    order_for_vertex_cache(after, place.size(), place);
    for (Corners& t : before) {
        for (std::uint32_t& v : t) v = place[v];
        t = rotated_to_smallest(t);
    }
    for (Corners& t : after) t = rotated_to_smallest(t);
    std::sort(before.begin(), before.end());
    std::sort(after.begin(), after.end());
    EXPECT_EQ(before, after);
}

TEST(VertexCacheOrder, NumbersVerticesByFirstUseAndMarksTheUnused) {
    std::vector<Corners> triangles = shuffled_grid(30);
    for (Corners& t : triangles) {
        for (std::uint32_t& v : t) v = 2 * v + 1;  // every even vertex is unused
    }
    const std::uint64_t n = 2 * 31 * 31;
    std::vector<std::uint32_t> place(n, 12345);
    order_for_vertex_cache(triangles, n, place);
    std::uint32_t next = 0;
    for (const Corners& t : triangles) {
        for (const std::uint32_t v : t) {
            ASSERT_LE(v, next);
            next = std::max(next, v + 1);
        }
    }
    EXPECT_EQ(next, n / 2);
    std::vector<bool> is_taken(n / 2);
    for (std::uint64_t v = 0; v < n; ++v) {
        if (v % 2 == 0) {
            ASSERT_EQ(place[v], kUnusedVertex);
        } else {
            ASSERT_LT(place[v], n / 2);
            ASSERT_FALSE(is_taken[place[v]]);
            is_taken[place[v]] = true;
        }
    }
}

TEST(VertexCacheOrder, IsTheSameEveryTime) {
    std::vector<Corners> a = shuffled_grid(50), b = a;
    std::vector<std::uint32_t> place_a(51 * 51), place_b(51 * 51);
    order_for_vertex_cache(a, place_a.size(), place_a);
    order_for_vertex_cache(b, place_b.size(), place_b);
    EXPECT_EQ(a, b);
    EXPECT_EQ(place_a, place_b);
}

TEST(VertexCacheOrder, HoldsWhatItSays) {
    std::vector<Corners> triangles = shuffled_grid(100);
    std::vector<std::uint32_t> place(101 * 101);
    meshopt_setAllocator(counting_allocate, counting_free);
    order_for_vertex_cache(triangles, place.size(), place);
    meshopt_setAllocator(std::malloc, std::free);
    const std::uint64_t claimed = vertex_cache_order_bytes(triangles.size(), place.size());
    EXPECT_LE(g_peak, claimed);
    EXPECT_GT(g_peak, claimed * 9 / 10);
}

TEST(VertexCacheOrder, TakesAMeshWithoutTriangles) {
    std::vector<std::uint32_t> place(3, 0);
    order_for_vertex_cache({}, 3, place);
    EXPECT_EQ(place, std::vector<std::uint32_t>(3, kUnusedVertex));
    order_for_vertex_cache({}, 0, {});
}

TEST(VertexCacheOrder, RefusesCornersOutOfRangeAndWrongSizes) {
    std::vector<Corners> triangles{{0, 1, 3}};
    std::vector<std::uint32_t> place(3);
    EXPECT_THROW(order_for_vertex_cache(triangles, 3, place), InternalError);
    EXPECT_THROW(order_for_vertex_cache(triangles, 4, place), InternalError);
}

}  // namespace
}  // namespace hewer::streaming
