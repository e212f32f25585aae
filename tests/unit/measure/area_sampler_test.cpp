// SPDX-License-Identifier: MIT
#include "measure/area_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "measure/triangle_distance.h"

namespace hewer::measuring {
namespace {

/// Right triangles side by side, areas in the ratio 1 : 2 : 3 : 0 : 1 : 2 ...
std::vector<LatticeTriangle> strip(std::int32_t n) {
    std::vector<LatticeTriangle> triangles;
    for (std::int32_t i = 0; i < n; ++i) {
        const std::int32_t x = i * 1000;
        const std::int32_t h = (i + 1) % 4 * 1000;
        triangles.push_back({{{x, 0, 0}, {x + 1000, 0, 0}, {x, h, 0}}});
    }
    return triangles;
}

constexpr double kStripArea = 1.5 * 500'000;  // of each triangle, in the mean

TEST(AreaSampler, GivesEachTriangleItsShare) {
    const AreaSampler sampler(3000 * kStripArea, 45'000, 1);
    std::uint64_t total = 0;
    const std::vector<LatticeTriangle> triangles = strip(3000);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        std::uint64_t n = 0;
        sampler.for_samples(triangles[i], [&](const Vec3& p) {
            ++n;
            ASSERT_LT(squared_distance(p, triangles[i]), 1e-12);
        });
        EXPECT_EQ(n, sampler.count(triangles[i]));
        EXPECT_NEAR(static_cast<double>(n), static_cast<double>((i + 1) % 4) * 10, 1);
        total += n;
    }
    EXPECT_NEAR(static_cast<double>(total), 45'000, 100);
}

TEST(AreaSampler, RoundsSharesBelowOneSoThatTheirMeanIsRight) {
    const AreaSampler sampler(100'000 * kStripArea, 15'000, 7);  // 0.1, 0.2 and 0.3 each
    std::vector<std::uint64_t> n(4);
    const std::vector<LatticeTriangle> triangles = strip(100'000);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        n[(i + 1) % 4] += sampler.count(triangles[i]);
    }
    EXPECT_EQ(n[0], 0U);
    for (std::size_t k = 1; k < 4; ++k) {
        EXPECT_NEAR(static_cast<double>(n[k]), 2500 * static_cast<double>(k), 250);
    }
    EXPECT_LT(n[1] + n[2] + n[3], AreaSampler::most(15'000));
}

TEST(AreaSampler, IsUniformWithinATriangle) {
    const LatticeTriangle t{{{0, 0, 0}, {30'000, 0, 0}, {0, 30'000, 0}}};
    const AreaSampler sampler(4.5e8, 100'000, 9);
    Vec3 mean{};
    int n_near_right_angle = 0;
    sampler.for_samples(t, [&](const Vec3& p) {
        for (std::size_t k = 0; k < 3; ++k) mean[k] += p[k] / 100'000;
        if (p[0] + p[1] < 15'000) ++n_near_right_angle;
    });
    EXPECT_NEAR(mean[0], 10'000, 20);
    EXPECT_NEAR(mean[1], 10'000, 20);
    EXPECT_NEAR(n_near_right_angle, 25'000, 100);
}

TEST(AreaSampler, SeedsGiveDifferentSamples) {
    const LatticeTriangle t = strip(1)[0];
    std::vector<Vec3> first;
    std::vector<Vec3> second;
    AreaSampler(500'000, 10, 1).for_samples(t, [&](const Vec3& p) { first.push_back(p); });
    AreaSampler(500'000, 10, 2).for_samples(t, [&](const Vec3& p) { second.push_back(p); });
    ASSERT_FALSE(first.empty());
    EXPECT_NE(first, second);
}

TEST(AreaSampler, SurfaceWithoutAreaHasNoSamples) {
    EXPECT_EQ(AreaSampler(0, 100, 1).count({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}), 0U);
    EXPECT_EQ(AreaSampler(1000, 100, 1).count({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}), 0U);
}

}  // namespace
}  // namespace hewer::measuring
