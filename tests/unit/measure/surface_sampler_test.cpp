// SPDX-License-Identifier: MIT
#include "measure/surface_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "measure/triangle_distance.h"

namespace hewer::measuring {
namespace {

constexpr std::uint64_t kMemory = 64 << 20;

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

TEST(SurfaceSampler, GivesEachTriangleItsShare) {
    const std::vector<LatticeTriangle> triangles = strip(3000);
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
    const SurfaceSampler sampler(context, triangles, 45'000, 1);
    EXPECT_DOUBLE_EQ(sampler.area(), 3000 * 1.5 * 500'000);
    std::vector<int> hits(triangles.size());
    std::uint64_t n = 0;
    sampler.for_samples(0, 45'000, [&](const Vec3& p, std::uint64_t t) {
        ++hits[t];
        ++n;
        ASSERT_LT(squared_distance(p, triangles[t]), 1e-12);
    });
    EXPECT_EQ(n, 45'000U);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        // Ten samples to an area of one; the stretches at both ends may be shared.
        const int expected = static_cast<int>((i + 1) % 4) * 10;
        if (expected == 0) {
            EXPECT_EQ(hits[i], 0);
        } else {
            EXPECT_NEAR(hits[i], expected, 2);
        }
    }
}

TEST(SurfaceSampler, SampleDoesNotDependOnWhereTheWalkBegan) {
    const std::vector<LatticeTriangle> triangles = strip(5000);
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 2});
    const SurfaceSampler sampler(context, triangles, 7000, 42);
    std::vector<Vec3> whole;
    sampler.for_samples(0, 7000, [&](const Vec3& p, std::uint64_t) { whole.push_back(p); });
    std::vector<Vec3> parts;
    for (std::uint64_t k = 0; k < 7000; k += 77) {
        sampler.for_samples(k, std::min<std::uint64_t>(7000, k + 77),
                            [&](const Vec3& p, std::uint64_t) { parts.push_back(p); });
    }
    EXPECT_EQ(whole, parts);
}

TEST(SurfaceSampler, IsUniformWithinATriangle) {
    const std::vector<LatticeTriangle> triangles{{{{0, 0, 0}, {30'000, 0, 0}, {0, 30'000, 0}}}};
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 1});
    const SurfaceSampler sampler(context, triangles, 100'000, 9);
    Vec3 mean{};
    int n_near_right_angle = 0;
    sampler.for_samples(0, 100'000, [&](const Vec3& p, std::uint64_t) {
        for (std::size_t k = 0; k < 3; ++k) mean[k] += p[k] / 100'000;
        if (p[0] + p[1] < 15'000) ++n_near_right_angle;
    });
    EXPECT_NEAR(mean[0], 10'000, 100);
    EXPECT_NEAR(mean[1], 10'000, 100);
    EXPECT_NEAR(n_near_right_angle, 25'000, 600);
}

TEST(SurfaceSampler, SeedsGiveDifferentSamples) {
    const std::vector<LatticeTriangle> triangles = strip(10);
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 1});
    Vec3 first{};
    Vec3 second{};
    SurfaceSampler(context, triangles, 10, 1).for_samples(0, 1, [&](const Vec3& p, std::uint64_t) {
        first = p;
    });
    SurfaceSampler(context, triangles, 10, 2).for_samples(0, 1, [&](const Vec3& p, std::uint64_t) {
        second = p;
    });
    EXPECT_NE(first, second);
}

TEST(SurfaceSampler, SurfaceWithoutAreaHasNoSamples) {
    const std::vector<LatticeTriangle> triangles{{{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}};
    ooc::Context context({.memory_bytes = kMemory, .n_threads = 1});
    EXPECT_EQ(SurfaceSampler(context, triangles, 100, 1).n_samples(), 0U);
}

}  // namespace
}  // namespace hewer::measuring
