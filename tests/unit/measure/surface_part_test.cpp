// SPDX-License-Identifier: MIT
#include "hewer/surface_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tests/support/shapes.h"

namespace hewer {
namespace {

using Corners = std::array<Vec3, 3>;

MeasureOptions limits(unsigned n_threads, std::uint64_t memory_bytes = 128 << 20) {
    MeasureOptions options;
    options.memory_bytes = memory_bytes;
    options.n_threads = n_threads;
    return options;
}

Corners corners_of(const Mesh& mesh, const Triangle& t) {
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

bool touches(const Corners& t, const Bounds& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [lo, hi] = std::minmax({t[0][k], t[1][k], t[2][k]});
        if (hi < box.min[k] || lo > box.max[k]) return false;
    }
    return true;
}

std::vector<Bounds> random_boxes(std::uint64_t seed, std::size_t n) {
    test::Random random(seed);
    std::vector<Bounds> boxes(n);
    for (Bounds& box : boxes) {
        const Vec3 at{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double half = random.between(0, 0.2);
        box.extend(Vec3{at[0] - half, at[1] - half, at[2] - half});
        box.extend(Vec3{at[0] + half, at[1] + half, at[2] + half});
    }
    return boxes;
}

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

TEST(SurfacePart, HasTheTrianglesThatTouchABoxAndNoOthers) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        const Mesh mesh = test::cube_sphere(20, 0.1, seed);
        const std::vector<Bounds> boxes = random_boxes(seed, 5);
        const std::optional<Mesh> part =
            part_of_surface(*view_mesh(mesh), boxes, kAll, limits(1 + seed % 3));
        ASSERT_TRUE(part);
        std::vector<Corners> wanted;
        for (const Triangle& t : mesh.triangles) {
            const Corners corners = corners_of(mesh, t);
            if (std::any_of(boxes.begin(), boxes.end(),
                            [&](const Bounds& box) { return touches(corners, box); })) {
                wanted.push_back(corners);
            }
        }
        std::sort(wanted.begin(), wanted.end());
        ASSERT_FALSE(wanted.empty());
        ASSERT_EQ(part->triangles.size(), wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            EXPECT_EQ(corners_of(*part, part->triangles[i]), wanted[i]);
        }
    }
}

TEST(SurfacePart, IsNothingWhereThereWouldBeTooMuch) {
    const Mesh mesh = test::cube_sphere(10, 0, 1);
    Bounds all;
    all.extend(Vec3{-2, -2, -2});
    all.extend(Vec3{2, 2, 2});
    const std::vector<Bounds> boxes{all};
    EXPECT_TRUE(part_of_surface(*view_mesh(mesh), boxes, mesh.triangles.size(), limits(2)));
    EXPECT_FALSE(part_of_surface(*view_mesh(mesh), boxes, mesh.triangles.size() - 1, limits(2)));
}

TEST(SurfacePart, OfNoBoxIsEmpty) {
    const std::optional<Mesh> part =
        part_of_surface(*view_mesh(test::cube_sphere(4, 0, 1)), {}, kAll, limits(2));
    ASSERT_TRUE(part);
    EXPECT_TRUE(part->triangles.empty());
}

}  // namespace
}  // namespace hewer
