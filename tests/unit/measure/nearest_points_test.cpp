// SPDX-License-Identifier: MIT
#include "hewer/nearest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "hewer/error.h"
#include "measure/triangle_distance.h"
#include "tests/support/shapes.h"

namespace hewer {
namespace {

using measuring::detail::dot;
using measuring::detail::minus;

std::vector<Vec3> random_points(std::size_t n) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1.5, 1.5);
    std::vector<Vec3> points(n);
    for (Vec3& p : points) {
        for (double& x : p) x = place(random);
    }
    return points;
}

/// On a lattice so fine that its rounding does not show in the tests' tolerance.
double distance_from(const Mesh& mesh, const Vec3& p) {
    constexpr double kSteps = 1 << 28;
    const auto on_lattice = [](const Vec3& q) {
        measuring::LatticePoint point{};
        for (std::size_t k = 0; k < 3; ++k) {
            point[k] = static_cast<std::int32_t>(std::lround(q[k] * kSteps));
        }
        return point;
    };
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles) {
        const measuring::LatticeTriangle corners{on_lattice(mesh.positions[t[0]]),
                                                 on_lattice(mesh.positions[t[1]]),
                                                 on_lattice(mesh.positions[t[2]])};
        const Vec3 q{p[0] * kSteps, p[1] * kSteps, p[2] * kSteps};
        least = std::min(least, measuring::squared_distance(q, corners));
    }
    return std::sqrt(least) / kSteps;
}

TEST(NearestPoints, AreOnTheSurfaceAndAsFarAsItIs) {
    const Mesh mesh = test::cube_sphere(6, 0.1, 2);
    const auto source = view_mesh(mesh);
    const std::vector<Vec3> points = random_points(60);
    const auto found = nearest_points(*source, points, 10);
    ASSERT_EQ(found.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_TRUE(found[i]);
        const Vec3 way = minus(points[i], *found[i]);
        EXPECT_NEAR(std::sqrt(dot(way, way)), distance_from(mesh, points[i]), 1e-7);
        EXPECT_LT(distance_from(mesh, *found[i]), 1e-7);
    }
}

TEST(NearestPoints, ThatAreTooFarAreNone) {
    const Mesh mesh = test::cube_sphere(6);
    const auto source = view_mesh(mesh);
    const std::vector<Vec3> points = random_points(60);
    std::size_t n_near = 0;
    const auto found = nearest_points(*source, points, 0.3);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(found[i].has_value(), distance_from(mesh, points[i]) <= 0.3);
        if (found[i]) ++n_near;
    }
    EXPECT_GT(n_near, 5U);
    EXPECT_LT(n_near, 55U);
}

TEST(NearestPoints, AreTheSameForAnyThreadsAndMemoryAndOrderOfTriangles) {
    const Mesh mesh = test::cube_sphere(40, 0.1, 3);
    const std::vector<Vec3> points = random_points(40);
    const auto expected = nearest_points(*view_mesh(mesh), points, 10);
    const Mesh other_order = test::shuffled(mesh, 5);
    for (const unsigned n_threads : {1U, 3U}) {
        for (const std::uint64_t memory : {std::uint64_t{24} << 20, std::uint64_t{1} << 30}) {
            for (const Mesh* m : {&mesh, &other_order}) {
                MeasureOptions options;
                options.n_threads = n_threads;
                options.memory_bytes = memory;
                const auto found = nearest_points(*view_mesh(*m), points, 10, options);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    ASSERT_TRUE(found[i] && expected[i]);
                    const Vec3 way = minus(*found[i], *expected[i]);
                    // Equal but for the rounding of a triangle whose first corner is another.
                    EXPECT_LT(std::sqrt(dot(way, way)), m == &mesh ? 1e-300 : 1e-6);
                }
            }
        }
    }
}

TEST(NearestPoints, NoPointsNeedNoSurface) {
    const Mesh empty;
    EXPECT_TRUE(nearest_points(*view_mesh(empty), {}, 1).empty());
    const std::vector<Vec3> one(1);
    EXPECT_THROW((void)nearest_points(*view_mesh(empty), one, 1), InvalidArgument);
}

}  // namespace
}  // namespace hewer
