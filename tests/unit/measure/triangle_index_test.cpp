// SPDX-License-Identifier: MIT
#include "measure/triangle_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "measure/triangle_distance.h"

namespace hewer::measuring {
namespace {

constexpr std::uint64_t kMemory = 256 << 20;

std::int32_t random_coordinate(std::mt19937& random, std::int32_t radius) {
    return std::uniform_int_distribution<std::int32_t>(-radius, radius)(random);
}

LatticePoint random_point(std::mt19937& random, std::int32_t radius = kLatticeRadius) {
    return {random_coordinate(random, radius), random_coordinate(random, radius),
            random_coordinate(random, radius)};
}

/// Small triangles anywhere, some of them needles, segments or points.
std::vector<LatticeTriangle> random_triangles(std::mt19937& random, std::size_t n,
                                              std::int32_t size) {
    std::vector<LatticeTriangle> triangles(n);
    for (LatticeTriangle& t : triangles) {
        t[0] = random_point(random, kLatticeRadius - 2 * size);
        for (std::size_t c = 1; c < 3; ++c) {
            for (std::size_t k = 0; k < 3; ++k) {
                t[c][k] = t[0][k] + random_coordinate(random, size);
            }
        }
        if (random() % 16 == 0) t[2] = t[1];
        if (random() % 16 == 0) t[1] = t[0];
    }
    return triangles;
}

TriangleIndex make_index(ooc::Context& context, const std::vector<LatticeTriangle>& triangles) {
    ooc::Array<LatticeTriangle> array(context.budget(), "triangles", triangles.size());
    std::copy(triangles.begin(), triangles.end(), array.begin());
    return {context, std::move(array), triangles.size()};
}

double brute_force(const std::vector<LatticeTriangle>& triangles, const Vec3& q) {
    double least = std::numeric_limits<double>::infinity();
    for (const LatticeTriangle& t : triangles) least = std::min(least, squared_distance(q, t));
    return least;
}

/// Distance by a search over barycentric coordinates on a fine grid: slow, and sure.
double sampled_distance(const Vec3& q, const LatticeTriangle& t, int n) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; i + j <= n; ++j) {
            double d2 = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double x =
                    (static_cast<double>(t[0][k]) * (n - i - j) + static_cast<double>(t[1][k]) * i +
                     static_cast<double>(t[2][k]) * j) /
                    n;
                d2 += (q[k] - x) * (q[k] - x);
            }
            least = std::min(least, d2);
        }
    }
    return std::sqrt(least);
}

TEST(TriangleDistance, IsThatToFaceEdgeOrCorner) {
    const LatticeTriangle t{{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}}};
    EXPECT_DOUBLE_EQ(squared_distance({20, 20, 7}, t), 49);
    EXPECT_DOUBLE_EQ(squared_distance({50, -3, 4}, t), 25);
    EXPECT_DOUBLE_EQ(squared_distance({60, 60, 0}, t), 200);
    EXPECT_DOUBLE_EQ(squared_distance({103, -4, 0}, t), 25);
    EXPECT_DOUBLE_EQ(squared_distance({-2, -3, 6}, t), 49);
    EXPECT_DOUBLE_EQ(squared_distance({30, 30, 0}, t), 0);
}

TEST(TriangleDistance, OfDegenerateTrianglesIsThatToTheSegmentOrPoint) {
    const LatticeTriangle segment{{{0, 0, 0}, {100, 0, 0}, {30, 0, 0}}};
    EXPECT_DOUBLE_EQ(squared_distance({70, 3, 4}, segment), 25);
    EXPECT_DOUBLE_EQ(squared_distance({-3, 0, 4}, segment), 25);
    const LatticeTriangle point{{{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}};
    EXPECT_DOUBLE_EQ(squared_distance({5, 9, 8}, point), 25);
}

TEST(TriangleDistance, OfALongNeedleIsExact) {
    // One step high over 2^31: any tolerance for degeneracy would be off by the whole distance.
    const LatticeTriangle needle{
        {{-kLatticeRadius, 0, 0}, {kLatticeRadius, 0, 0}, {kLatticeRadius, 1, 0}}};
    EXPECT_NEAR(std::sqrt(squared_distance({0, 0.25, 12345}, needle)), 12345, 1e-6);
    EXPECT_NEAR(std::sqrt(squared_distance({0, -3, 0}, needle)), 3, 1e-6);
    EXPECT_NEAR(std::sqrt(squared_distance({kLatticeRadius - 8.0, 0.5, 2}, needle)), 2, 1e-6);
}

TEST(TriangleDistance, AgreesWithASearchOverTheTriangle) {
    std::mt19937 random(3);
    for (const LatticeTriangle& t : random_triangles(random, 40, 100'000'000)) {
        for (int i = 0; i < 5; ++i) {
            Vec3 q = to_double(t[0]);
            for (double& x : q) x += random_coordinate(random, 150'000'000);
            const double exact = std::sqrt(squared_distance(q, t));
            const double sampled = sampled_distance(q, t, 200);
            EXPECT_LE(exact, sampled * (1 + 1e-12));
            EXPECT_GE(exact, sampled - 2e6);  // half the spacing of the search
        }
    }
}

TEST(TriangleIndex, FindsTheSameDistanceAsBruteForce) {
    for (const std::size_t n : {1UL, 3UL, 4UL, 5UL, 32UL, 33UL, 257UL, 3000UL}) {
        for (const std::int32_t size : {1000, 100'000'000}) {
            std::mt19937 random(static_cast<unsigned>(n));
            const std::vector<LatticeTriangle> triangles = random_triangles(random, n, size);
            ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
            const TriangleIndex index = make_index(context, triangles);
            std::uint64_t guess = 0;
            for (int i = 0; i < 300; ++i) {
                Vec3 q = to_double(random_point(random));
                // Half of them on or near a triangle, off the lattice.
                if (i % 2 == 0) {
                    q = to_double(triangles[static_cast<std::size_t>(random()) % n][1]);
                    q[0] += 0.375;
                    q[1] -= 0.4375;
                }
                const TriangleIndex::Nearest nearest = index.nearest(q, guess);
                const double expected = brute_force(triangles, q);
                ASSERT_NEAR(nearest.squared_distance, expected, 1e-12 * expected);
                ASSERT_EQ(squared_distance(q, index.triangles()[nearest.triangle]),
                          nearest.squared_distance);
                guess = nearest.triangle;
            }
        }
    }
}

TEST(TriangleIndex, OrderDependsOnTheSetOfTrianglesAlone) {
    std::mt19937 random(5);
    std::vector<LatticeTriangle> triangles = random_triangles(random, 100'000, 1'000'000);
    for (std::size_t i = 0; i < 500; ++i) triangles[i] = triangles[i + 500];  // ties
    ooc::Context one({.memory_bytes = kMemory, .n_threads = 1});
    const TriangleIndex first = make_index(one, triangles);
    std::shuffle(triangles.begin(), triangles.end(), random);
    ooc::Context eight({.memory_bytes = kMemory, .n_threads = 8});
    const TriangleIndex second = make_index(eight, triangles);
    EXPECT_TRUE(std::equal(first.triangles().begin(), first.triangles().end(),
                           second.triangles().begin(), second.triangles().end()));
}

TEST(TriangleIndex, TakesTheBytesItStates) {
    std::mt19937 random(7);
    const std::vector<LatticeTriangle> triangles = random_triangles(random, 50'000, 1000);
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
    const std::uint64_t before = context.budget().used();
    const TriangleIndex index = make_index(context, triangles);
    EXPECT_EQ(context.budget().used() - before, TriangleIndex::bytes(triangles.size()));
    EXPECT_EQ(context.budget().peak(), context.budget().used());
    EXPECT_LE(TriangleIndex::bytes(1'000'000), 43'000'000U);
}

}  // namespace
}  // namespace hewer::measuring
