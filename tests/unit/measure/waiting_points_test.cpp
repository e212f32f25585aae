// SPDX-License-Identifier: MIT
#include "measure/waiting_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "measure/triangle_distance.h"
#include "ooc/parallel.h"

namespace hewer::measuring {
namespace {

constexpr std::uint64_t kMemory = 256 << 20;

std::int32_t coordinate(std::mt19937& random, std::int32_t radius) {
    return std::uniform_int_distribution<std::int32_t>(-radius, radius)(random);
}

/// Triangles of a size about one point or all over the lattice, some of them degenerate.
std::vector<LatticeTriangle> triangles_of(std::mt19937& random, std::size_t n, std::int32_t size,
                                          std::int32_t radius) {
    std::vector<LatticeTriangle> triangles(n);
    for (LatticeTriangle& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) t[0][k] = coordinate(random, radius);
        for (std::size_t c = 1; c < 3; ++c) {
            for (std::size_t k = 0; k < 3; ++k) t[c][k] = t[0][k] + coordinate(random, size);
        }
        if (random() % 16 == 0) t[2] = t[1];
        if (random() % 16 == 0) t[1] = t[0];
    }
    return triangles;
}

std::vector<Vec3> points_of(std::mt19937& random, std::size_t n, std::int32_t radius) {
    std::vector<Vec3> points(n);
    for (Vec3& p : points) {
        for (double& x : p) x = coordinate(random, radius) + 0.4375;
    }
    return points;
}

template <typename T>
ooc::Array<T> array_of(ooc::Context& context, const std::vector<T>& values) {
    ooc::Array<T> array(context.budget(), "values", values.size());
    std::copy(values.begin(), values.end(), array.begin());
    return array;
}

/// With `n_noted` corners noted and the triangles in pieces, on two threads.
WaitingPoints wait_for(ooc::Context& context, const std::vector<Vec3>& points,
                       const std::vector<LatticeTriangle>& triangles, std::size_t n_noted) {
    WaitingPoints waiting(context, array_of(context, points), 1e12);
    for (std::size_t i = 0; i < n_noted; ++i) waiting.note(triangles[i % triangles.size()][i % 3]);
    const LatticePoint& any = triangles[0][0];
    waiting.settle(context, array_of<LatticeTriangle>(context, {{any, any, any}}), 1);
    context.workers().for_ranges(triangles.size(), 97, [&](std::uint64_t begin, std::uint64_t end) {
        waiting.meet(std::span(triangles).subspan(begin, end - begin));
    });
    return waiting;
}

TEST(WaitingPoints, FindTheSameDistancesAsBruteForce) {
    for (const auto& [size, triangle_radius, point_radius] :
         {std::tuple{1000, 1'000'000, 1'000'000},
          {50'000'000, 900'000'000, 1'000'000'000},
          {3000, 2000, 1'000'000'000},
          {100'000'000, 100'000'000, 500}}) {
        for (const std::size_t n : {1UL, 7UL, 8UL, 9UL, 65UL, 700UL}) {
            std::mt19937 random(static_cast<unsigned>(n));
            const auto triangles = triangles_of(random, 1500, size, triangle_radius);
            const auto points = points_of(random, n, point_radius);
            for (const std::size_t n_noted : {0UL, 20UL, 1500UL}) {
                ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
                const WaitingPoints waiting = wait_for(context, points, triangles, n_noted);
                ASSERT_EQ(waiting.size(), n);
                for (std::size_t i = 0; i < n; ++i) {
                    double least = std::numeric_limits<double>::infinity();
                    for (const LatticeTriangle& t : triangles) {
                        least = std::min(least, squared_distance(points[i], t));
                    }
                    ASSERT_EQ(waiting.squared_distance(i), least) << i << " of " << n;
                    ASSERT_EQ(waiting.point(i), points[i]);
                }
            }
        }
    }
}

TEST(WaitingPoints, SurfaceAlongAStripIsLookedUpInGroupsAndFoundAllTheSame) {
    // Triangles side by side, as files have them: groups form, grow and end.
    std::mt19937 random(3);
    std::vector<LatticeTriangle> triangles;
    triangles.reserve(5000);
    for (std::int32_t i = 0; i < 5000; ++i) {
        const std::int32_t x = i * 1000;
        const std::int32_t z = coordinate(random, 3000);
        triangles.push_back({{{x, 0, z}, {x + 1000, 0, z}, {x, 1000, z + 500}}});
    }
    std::vector<Vec3> points;
    points.reserve(300);
    for (std::int32_t i = 0; i < 300; ++i) {
        points.push_back({i * 16'667.0, 400, coordinate(random, 100'000) + 0.5});
    }
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
    const WaitingPoints waiting = wait_for(context, points, triangles, 5000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        double least = std::numeric_limits<double>::infinity();
        for (const LatticeTriangle& t : triangles) {
            least = std::min(least, squared_distance(points[i], t));
        }
        ASSERT_EQ(waiting.squared_distance(i), least);
    }
}

TEST(WaitingPoints, TakeTheBytesTheyState) {
    std::mt19937 random(7);
    for (const std::size_t n : {1UL, 513UL, 100'000UL}) {
        ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
        const std::uint64_t before = context.budget().used();
        const WaitingPoints waiting(context, array_of(context, points_of(random, n, 1000)), 1e6);
        EXPECT_EQ(context.budget().used() - before, WaitingPoints::bytes(n));
    }
    EXPECT_LE(WaitingPoints::bytes(1 << 20), 61ULL << 20);
}

TEST(WaitingPoints, PiecesFindWhatIsWithinReachOfTheirCenters) {
    for (const std::int32_t size : {3000, 200'000}) {
        std::mt19937 random(7);
        const auto triangles = triangles_of(random, 1500, size, 1'000'000);
        const std::vector<Piece> pieces = triangles_of(random, 700, size, 1'000'000);
        const double enough = 80'000.0 * 80'000;
        ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
        WaitingPoints waiting(context, array_of(context, pieces), enough);
        context.workers().for_ranges(
            triangles.size(), 97, [&](std::uint64_t begin, std::uint64_t end) {
                waiting.meet(std::span(triangles).subspan(begin, end - begin));
            });
        std::size_t n_near = 0;
        std::size_t n_far = 0;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            double least = std::numeric_limits<double>::infinity();
            LatticeTriangle first{};
            for (const LatticeTriangle& t : triangles) {
                if (squared_distance(center_of(pieces[i]), t) > enough) continue;
                const double d = squared_distance(pieces[i], t);
                if (d > least || (d == least && first < t)) continue;
                least = d;
                first = t;
            }
            if (least <= enough) {
                ++n_near;
                EXPECT_LE(waiting.squared_distance(i), enough);
            } else {
                EXPECT_EQ(waiting.squared_distance(i), least);
                if (std::isinf(least)) {
                    ++n_far;
                } else {
                    EXPECT_EQ(waiting.nearest(i), first);
                }
            }
        }
        EXPECT_GT(n_near, 20U);
        EXPECT_GT(n_far, 10U);
    }
}

}  // namespace
}  // namespace hewer::measuring
