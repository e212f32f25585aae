// SPDX-License-Identifier: MIT
#include "fidelity/neighbourhood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hewer/nearest_points.h"
#include "tests/support/shapes.h"

namespace hewer::fidelity {
namespace {

Bounds around(const Vec3& p, double half) {
    Bounds box;
    box.extend(Vec3{p[0] - half, p[1] - half, p[2] - half});
    box.extend(Vec3{p[0] + half, p[1] + half, p[2] + half});
    return box;
}

TEST(Neighbourhood, HasWhatIsWithinReachOfAllBoxesSoFar) {
    const Mesh mesh = test::cube_sphere(30, 0, 1);
    const auto original = view_mesh(mesh);
    const Judge judge(*original, {.n_threads = 2});
    Neighbourhood near(judge, 0.1);
    const std::vector<Vec3> places{mesh.positions[0], mesh.positions[500], mesh.positions[2000]};
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::vector<Bounds> boxes{around(places[i], 0.01)};
        ASSERT_TRUE(near.include(boxes, {}));
        EXPECT_LT(near.mesh().triangles.size(), mesh.triangles.size());
        // A point 0.1 above each place so far finds the surface there.
        std::vector<Vec3> points;
        for (std::size_t j = 0; j <= i; ++j) {
            const Vec3& p = places[j];
            points.push_back({1.1 * p[0], 1.1 * p[1], 1.1 * p[2]});
        }
        const auto here = nearest_points(*view_mesh(near.mesh()), points, 1);
        const auto wanted = nearest_points(*original, points, 1);
        for (std::size_t j = 0; j < points.size(); ++j) {
            ASSERT_TRUE(here[j] && wanted[j]);
            for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR((*here[j])[k], (*wanted[j])[k], 1e-6);
        }
    }
}

TEST(Neighbourhood, IsNotReadAgainForWhatItHas) {
    const Mesh mesh = test::cube_sphere(30, 0, 1);
    const auto original = view_mesh(mesh);
    const Judge judge(*original, {.n_threads = 2});
    Neighbourhood near(judge, 0.1);
    const std::vector<Bounds> boxes{around(mesh.positions[0], 0.05)};
    ASSERT_TRUE(near.include(boxes, {}));
    const Vec3* const before = near.mesh().positions.data();
    const std::vector<Bounds> inside{around(mesh.positions[0], 0.03)};
    ASSERT_TRUE(near.include(inside, {}));
    EXPECT_EQ(near.mesh().positions.data(), before);
}

TEST(Neighbourhood, StaysAsItWasWhereItWouldBeTooMuch) {
    const Mesh mesh = test::cube_sphere(150, 0, 1);  // 270,000 triangles
    const auto original = view_mesh(mesh);
    const Judge judge(*original, {.n_threads = 2});
    Neighbourhood near(judge, 0.01);
    const std::vector<Bounds> few{around(mesh.positions[0], 0.01)};
    ASSERT_TRUE(near.include(few, {}));
    const std::size_t before = near.mesh().triangles.size();
    const std::vector<Bounds> all{around({0, 0, 0}, 2)};
    EXPECT_FALSE(near.include(all, {}));
    EXPECT_EQ(near.mesh().triangles.size(), before);
}

}  // namespace
}  // namespace hewer::fidelity
