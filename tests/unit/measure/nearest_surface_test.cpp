// SPDX-License-Identifier: MIT
#include "measure/nearest_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hewer/error.h"
#include "tests/unit/measure/meshes.h"

namespace hewer::measuring {
namespace {

TEST(NearestSurface, FindsDistanceAndTriangleOfEachPointOfAStream) {
    const Mesh mesh = test::plane(50, 10, 2);
    const auto source = view_mesh(mesh);
    ooc::Context context({.memory_bytes = 64 << 20, .n_threads = 2});
    Bounds box;
    box.extend(Vec3{-5, -5, -5});
    box.extend(Vec3{15, 15, 15});
    const NearestSurface surface(context, *source, box);
    EXPECT_EQ(surface.n_triangles(), mesh.triangles.size());
    NearestSurface::Stream stream(surface);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(0, 10);
    for (int i = 0; i < 500; ++i) {
        const Vec3 p{place(random), place(random), place(random)};
        const NearestSurface::Found found = stream.nearest(p);
        EXPECT_NEAR(found.distance, std::abs(p[2] - 2), 1e-7);
        // Its square of .2 x .2 is below p.
        for (const Vec3& corner : found.corners) {
            EXPECT_NEAR(corner[0], p[0], 0.2 + 1e-7);
            EXPECT_NEAR(corner[1], p[1], 0.2 + 1e-7);
            EXPECT_NEAR(corner[2], 2, 1e-7);
        }
        NearestSurface::Stream fresh(surface);
        EXPECT_EQ(fresh.nearest(p).triangle, found.triangle);
    }
    EXPECT_NEAR(stream.nearest({-3, 5, -2}).distance, 5, 1e-7);
}

TEST(NearestSurface, RefusesASurfaceOfNothing) {
    const Mesh empty;
    const auto source = view_mesh(empty);
    ooc::Context context({.memory_bytes = 64 << 20, .n_threads = 1});
    EXPECT_THROW(NearestSurface(context, *source, Bounds()), InvalidArgument);
}

}  // namespace
}  // namespace hewer::measuring
