// SPDX-License-Identifier: MIT
#include "streaming/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "ooc/vec3.h"

namespace hewer::streaming {
namespace {

using Polygon = std::vector<Vec3>;

Vec3 area_vector(const Polygon& p, const std::array<std::uint32_t, 3>& t) {
    return 0.5 * cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
}

/// The triangles cover the polygon once: none is turned over, and their areas add up to its own.
void expect_covered(const Polygon& polygon) {
    PolygonTriangulation triangulation;
    const PolygonTriangles& triangles = triangulation.triangulate(polygon);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    Vec3 whole{0, 0, 0};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        whole = whole + 0.5 * cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
    const double area = std::sqrt(dot(whole, whole));
    double sum = 0;
    std::vector<int> n_uses(polygon.size(), 0);
    for (const auto& t : triangles) {
        const double signed_area = dot(area_vector(polygon, t), whole) / area;
        EXPECT_GE(signed_area, -1e-12 * area);
        sum += signed_area;
        for (const std::uint32_t corner : t) ++n_uses[corner];
    }
    EXPECT_NEAR(sum, area, 1e-9 * area);
    EXPECT_EQ(std::count(n_uses.begin(), n_uses.end(), 0), 0) << "a corner is in no triangle";
}

TEST(PolygonTriangulation, ConvexPolygonsBecomeTheFanOfTheirFirstCorner) {
    PolygonTriangulation triangulation;
    EXPECT_EQ(triangulation.triangulate(Polygon{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}),
              (PolygonTriangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(
        triangulation.triangulate(Polygon{{0, 0, 5}, {0, 2, 5}, {0, 3, 4}, {0, 2, 3}, {0, 0, 3}}),
        (PolygonTriangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(PolygonTriangulation, QuadsGetTheDiagonalThatLiesInside) {
    Polygon dart{{0, 0, 0}, {1, -1, 0}, {0, 2, 0}, {-1, -1, 0}};
    for (int turn = 0; turn < 4; ++turn) {
        expect_covered(dart);
        std::rotate(dart.begin(), dart.begin() + 1, dart.end());
    }
}

TEST(PolygonTriangulation, CoversConcavePolygonsInAnyPlane) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 200; ++round) {
        // Star-shaped around the origin of a random plane.
        const Vec3 x{uniform(random), uniform(random), uniform(random)};
        Vec3 y{uniform(random), uniform(random), uniform(random)};
        y = y - (dot(x, y) / dot(x, x)) * x;
        Polygon polygon;
        const int n = 5 + static_cast<int>(random() % 60);
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * 3.14159265358979 * i / n;
            const double radius = 1.2 + uniform(random);
            polygon.push_back(Vec3{1e4, -2e4, 3e4} + radius * std::cos(angle) * x +
                              radius * std::sin(angle) * y);
        }
        Polygon local;  // the areas of expect_covered() are exact near the origin only
        for (const Vec3& p : polygon) local.push_back(p - polygon[0]);
        expect_covered(local);
        if (HasFailure()) return;
    }
}

TEST(PolygonTriangulation, CoversCombsAndSpiralsAndCollinearCorners) {
    Polygon comb;
    for (int i = 0; i < 50; ++i) {
        comb.push_back({2.0 * i, 0, 0});
        comb.push_back({2.0 * i + 1, i == 25 ? 0.5 : 10.0, 0});
    }
    comb.push_back({100, -1, 0});
    comb.push_back({0, -1, 0});
    std::reverse(comb.begin(), comb.end());
    expect_covered(comb);

    Polygon spiral;
    for (int i = 0; i < 200; ++i) {
        const double r = 1 + 0.05 * i;
        spiral.push_back({r * std::cos(0.2 * i), r * std::sin(0.2 * i), 0});
    }
    for (int i = 199; i >= 0; --i) {
        const double r = 0.6 + 0.05 * i;
        spiral.push_back({r * std::cos(0.2 * i), r * std::sin(0.2 * i), 0});
    }
    expect_covered(spiral);

    expect_covered({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 1, 0}, {0, 2, 0}, {0, 1, 0}});
}

TEST(PolygonTriangulation, CoversPolygonsWithAHoleJoinedByABridge) {
    expect_covered({{0, 0, 0},
                    {4, 0, 0},
                    {4, 4, 0},
                    {0, 4, 0},
                    {0, 0, 0},
                    {1, 1, 0},
                    {1, 3, 0},
                    {3, 3, 0},
                    {3, 1, 0},
                    {1, 1, 0}});
}

TEST(PolygonTriangulation, WhatHasNoPlaneIsCutAnyway) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    PolygonTriangulation triangulation;
    const PolygonTriangles fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    EXPECT_EQ(triangulation.triangulate(Polygon(5, Vec3{1, 1, 1})), fan);
    EXPECT_EQ(triangulation.triangulate(
                  Polygon{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {-1, -1, -1}}),
              fan);
    EXPECT_EQ(triangulation.triangulate(
                  Polygon{{0, 0, 0}, {1, 0, 0}, {kNan, 1, 0}, {0, 1, 0}, {0, 0.5, 0}}),
              fan);
    // Intersects itself: n - 2 triangles whatever they are.
    std::mt19937 random(5);
    for (int round = 0; round < 100; ++round) {
        Polygon tangle;
        for (std::size_t n = 5 + random() % 30; n > 0; --n) {
            tangle.push_back({double(random() % 7), double(random() % 7), double(random() % 3)});
        }
        EXPECT_EQ(triangulation.triangulate(tangle).size(), tangle.size() - 2);
    }
}

}  // namespace
}  // namespace hewer::streaming
