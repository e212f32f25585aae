// SPDX-License-Identifier: MIT
#include "rsimp/edge_collapse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rsimp/cluster_summary.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/collapse_mesh.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();

Mesh large(const Mesh& mesh) {
    return test::scaled(mesh, {50, 50, 50});
}

Mesh collapsed(const Mesh& mesh, const CollapseTarget& target, unsigned n_threads = 2) {
    const auto context = test::make_context(n_threads);
    EdgeCollapse collapse(*context, test::collapse_mesh(*context, mesh));
    const std::uint64_t n = collapse.run(target);
    Mesh result = test::live_mesh(collapse);
    EXPECT_EQ(result.triangles.size(), collapse.n_triangles());
    EXPECT_EQ(result.positions.size(), collapse.n_vertices());
    EXPECT_EQ(mesh.positions.size() - result.positions.size(), n);
    return result;
}

}  // namespace

TEST(EdgeCollapse, EndsExactlyAtItsTarget) {
    const Mesh sphere = large(test::cube_sphere(20, 0.02));
    for (const std::uint64_t target : {4000U, 1001U, 500U, 37U, 4U}) {
        EXPECT_EQ(collapsed(sphere, {target, kAny, {}}).triangles.size(), target & ~1ULL);
    }
    for (const std::uint64_t target : {2000U, 333U, 4U}) {
        EXPECT_EQ(collapsed(sphere, {kAny, target, {}}).positions.size(), target);
    }
    const Mesh plane = large(test::plane_grid(30, 0.02));
    for (const std::uint64_t target : {1500U, 101U}) {
        const std::uint64_t n = collapsed(plane, {target, kAny, {}}).triangles.size();
        EXPECT_LE(n, target);
        EXPECT_GE(n + 1, target);
    }
}

TEST(EdgeCollapse, KeepsTheMeshManifoldAndItsType) {
    for (const std::uint64_t target : {1000U, 200U, 40U}) {
        const test::Counts sphere =
            test::count(collapsed(large(test::cube_sphere(20, 0.02)), {target, kAny, {}}));
        EXPECT_TRUE(sphere.is_clean() && sphere.is_closed());
        EXPECT_EQ(sphere.euler, 2);
        EXPECT_EQ(sphere.unlike_edges, 0U);
        const test::Counts torus =
            test::count(collapsed(large(test::torus(60, 30)), {target, kAny, {}}));
        EXPECT_TRUE(torus.is_clean() && torus.is_closed());
        EXPECT_EQ(torus.euler, 0);
        const test::Counts plane =
            test::count(collapsed(large(test::plane_grid(30, 0.02)), {target, kAny, {}}));
        EXPECT_TRUE(plane.is_clean());
        EXPECT_EQ(plane.euler, 1);
        const test::Counts strip =
            test::count(collapsed(large(test::moebius_strip(100, 8)), {target, kAny, {}}));
        EXPECT_TRUE(strip.is_clean());
        EXPECT_EQ(strip.euler, 0);
    }
}

TEST(EdgeCollapse, TurnsNoFaceOfASphereOver) {
    for (const std::uint64_t target : {2000U, 300U, 50U}) {
        const Mesh mesh = collapsed(large(test::cube_sphere(20)), {target, kAny, {}});
        for (const Triangle& t : mesh.triangles) {
            EXPECT_GT(dot(test::cross_of(mesh, t), mesh.positions[t[0]]), 0);
        }
        for (const Vec3& p : mesh.positions) {
            EXPECT_NEAR(std::sqrt(dot(p, p)), 50, target < 100 ? 15 : 3);
        }
    }
}

TEST(EdgeCollapse, KeepsTheOutlineOfAPlane) {
    for (const std::uint64_t target : {500U, 60U, 10U}) {
        const Mesh mesh = collapsed(large(test::plane_grid(30)), {target, kAny, {}});
        EXPECT_NEAR(test::area(mesh), 2500, 1);  // corners give way by a hair
        const Bounds bounds = test::bounds_of(mesh);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_NEAR(bounds.min[i], 0, 1e-3);
            EXPECT_NEAR(bounds.max[i], 50, 1e-3);
        }
        for (const Triangle& t : mesh.triangles) EXPECT_GT(test::cross_of(mesh, t)[2], 0);
    }
}

TEST(EdgeCollapse, NoVertexLeavesItsBoxByMoreThanTheBound) {
    const Mesh mesh = large(test::cube_sphere(20));
    const auto context = test::make_context();
    EdgeCollapse collapse(*context, test::collapse_mesh(*context, mesh));
    std::uint64_t before = mesh.triangles.size();
    // Each bound allows more than the one before.
    for (const double bound : {6.0, 12.0, 30.0}) {
        collapse.run({0, 0, bound});
        EXPECT_LT(collapse.n_triangles(), before);
        before = collapse.n_triangles();
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
            const Vec3& p = collapse.mesh().vertices[collapse.representative(v)].position;
            const Vec3 half{0.5, 0.5, 0.5};
            EXPECT_LE(farthest_corner(mesh.positions[v] - half, mesh.positions[v] + half, p),
                      bound + 1e-4);
        }
    }
}

TEST(EdgeCollapse, ThreadsDoNotShow) {
    const Mesh mesh = large(test::joined(test::cube_sphere(30, 0.03), test::torus(50, 20)));
    const Mesh expected = collapsed(mesh, {800, kAny, {}}, 1);
    for (const unsigned n_threads : {2U, 8U}) {
        const Mesh other = collapsed(mesh, {800, kAny, {}}, n_threads);
        EXPECT_EQ(other.triangles, expected.triangles);
        EXPECT_EQ(other.positions, expected.positions);
    }
}

TEST(EdgeCollapse, DropsWholeComponentsWhenNothingElseHelps) {
    // Eight small spheres and a large one.
    const Mesh mesh = large(
        test::joined(test::many_spheres(2, 5), test::translated(test::cube_sphere(10), {5, 0, 0})));
    const auto context = test::make_context();
    EdgeCollapse collapse(*context, test::collapse_mesh(*context, mesh));
    const CollapseTarget target{12, kAny, {}};
    collapse.run(target);
    EXPECT_EQ(collapse.n_triangles(), 36U);  // nine tetrahedra
    EXPECT_GT(collapse.drop_components(target), 0U);
    EXPECT_EQ(collapse.n_triangles(), 12U);
    EXPECT_EQ(
        collapse.representative(0) == kNoIndex || collapse.is_live(collapse.representative(0)),
        true);
    double largest = 0;
    for (const Vec3& p : test::live_mesh(collapse).positions) largest = std::max(largest, p[0]);
    EXPECT_GT(largest, 200);  // the large one stays
    collapse.drop_components({1, kAny, {}});
    EXPECT_EQ(collapse.n_triangles(), 4U);  // one component stays
}

}  // namespace hewer::rsimp
