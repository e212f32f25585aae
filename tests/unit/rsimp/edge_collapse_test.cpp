// SPDX-License-Identifier: MIT
#include "rsimp/edge_collapse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/collapse_cut.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/block_meshes.h"

namespace hewer::rsimp {

namespace {

Mesh large(const Mesh& mesh) {
    return test::scaled(mesh, {50, 50, 50});
}

Mesh collapsed(const Mesh& mesh, const CollapseLimit& limit) {
    BlockMesh block = test::free_block(mesh);
    ooc::Workers workers(2);
    EdgeCollapse collapse(workers, block, {});
    collapse.run(limit);
    apply_steps(block, collapse.steps(), nullptr);
    return test::to_mesh(block);
}

Mesh collapsed_to(const Mesh& mesh, std::uint64_t n_triangles) {
    CollapseLimit limit;
    limit.most_faces = mesh.triangles.size() - n_triangles;
    return collapsed(mesh, limit);
}

}  // namespace

TEST(EdgeCollapse, EndsExactlyAtItsLimit) {
    const Mesh sphere = large(test::cube_sphere(20, 0.02));
    for (const std::uint64_t target : {4000U, 1001U, 500U, 37U, 4U}) {
        EXPECT_EQ(collapsed_to(sphere, target).triangles.size(), target & ~1ULL);
    }
    for (const std::uint64_t target : {2000U, 333U, 4U}) {
        CollapseLimit limit;
        limit.most_vertices = sphere.positions.size() - target;
        EXPECT_EQ(collapsed(sphere, limit).positions.size(), target);
    }
    const Mesh plane = large(test::plane_grid(30, 0.02));
    for (const std::uint64_t target : {1500U, 101U}) {
        const std::uint64_t n = collapsed_to(plane, target).triangles.size();
        EXPECT_LE(n, target);
        EXPECT_GE(n + 1, target);
    }
}

TEST(EdgeCollapse, KeepsTheMeshManifoldAndItsType) {
    for (const std::uint64_t target : {1000U, 200U, 40U}) {
        const test::Counts sphere =
            test::count(collapsed_to(large(test::cube_sphere(20, 0.02)), target));
        EXPECT_TRUE(sphere.is_clean() && sphere.is_closed());
        EXPECT_EQ(sphere.euler, 2);
        EXPECT_EQ(sphere.unlike_edges, 0U);
        const test::Counts torus = test::count(collapsed_to(large(test::torus(60, 30)), target));
        EXPECT_TRUE(torus.is_clean() && torus.is_closed());
        EXPECT_EQ(torus.euler, 0);
        const test::Counts plane =
            test::count(collapsed_to(large(test::plane_grid(30, 0.02)), target));
        EXPECT_TRUE(plane.is_clean());
        EXPECT_EQ(plane.euler, 1);
        const test::Counts strip =
            test::count(collapsed_to(large(test::moebius_strip(100, 8)), target));
        EXPECT_TRUE(strip.is_clean());
        EXPECT_EQ(strip.euler, 0);
    }
}

TEST(EdgeCollapse, TurnsNoFaceOfASphereOver) {
    for (const std::uint64_t target : {2000U, 300U, 50U}) {
        const Mesh mesh = collapsed_to(large(test::cube_sphere(20)), target);
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
        const Mesh mesh = collapsed_to(large(test::plane_grid(30)), target);
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
    std::size_t before = mesh.triangles.size();
    // Each bound allows more than the one before.
    for (const double bound : {6.0, 12.0, 30.0}) {
        BlockMesh block = test::free_block(mesh);
        ooc::Workers workers(2);
        EdgeCollapse collapse(workers, block, {bound});
        collapse.run({});
        EXPECT_TRUE(collapse.is_finished());
        apply_steps(block, collapse.steps(), nullptr);
        EXPECT_LT(block.faces.size(), before);
        before = block.faces.size();
        for (const StoredVertex& v : block.vertices) {
            const auto& box = v.vertex.box;
            EXPECT_LE(farthest_corner({box[0], box[1], box[2]}, {box[3], box[4], box[5]},
                                      v.vertex.position),
                      bound + 1e-4);
        }
    }
}

TEST(EdgeCollapse, ARunThatGoesOnMakesTheSameSteps) {
    const BlockMesh block = test::free_block(large(test::cube_sphere(20, 0.03)));
    ooc::Workers workers(2);
    EdgeCollapse at_once(workers, block, {});
    CollapseLimit limit;
    limit.most_vertices = 1500;
    at_once.run(limit);
    EdgeCollapse in_parts(workers, block, {});
    for (const std::uint64_t n : {1U, 17U, 500U, 1499U, 1500U}) {
        limit.most_vertices = n;
        in_parts.run(limit);
        EXPECT_EQ(in_parts.steps().size(), n);
    }
    ASSERT_EQ(at_once.steps().size(), in_parts.steps().size());
    float key = 0;
    for (std::size_t i = 0; i < at_once.steps().size(); ++i) {
        const CollapseStep& a = at_once.steps()[i];
        const CollapseStep& b = in_parts.steps()[i];
        EXPECT_EQ(a.position, b.position);
        EXPECT_EQ(a.kept, b.kept);
        EXPECT_EQ(a.gone, b.gone);
        EXPECT_GE(a.key, key);
        key = a.key;
    }
}

namespace {

/// A sphere and single triangles of one size beside it, each twice as far away as the one before.
Mesh sphere_and_flakes(std::size_t n_flakes) {
    Mesh mesh = large(test::cube_sphere(6));
    double x = 60;
    for (std::size_t i = 0; i < n_flakes; ++i, x *= 2) {
        Mesh flake;
        flake.positions = {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}};
        flake.triangles = {{0, 1, 2}};
        mesh = test::joined(std::move(mesh), flake);
    }
    return mesh;
}

std::vector<LostPart> collapse(BlockMesh& block, bool may_vanish, const CollapseLimit& limit) {
    ooc::Workers workers(2);
    EdgeCollapse collapse(workers, block, {{}, may_vanish});
    collapse.run(limit);
    return apply_steps(block, collapse.steps(), nullptr);
}

}  // namespace

TEST(EdgeCollapse, ComponentsVanishWholeAndNeverTheLastWhereThatIsAllowed) {
    const Mesh mesh = sphere_and_flakes(6);
    BlockMesh kept = test::free_block(mesh);
    EXPECT_TRUE(collapse(kept, false, {}).empty());
    EXPECT_EQ(kept.faces.size(), 4 + 6U);
    BlockMesh last = test::free_block(mesh);
    EXPECT_EQ(collapse(last, true, {}).size(), 6U);
    const test::Counts counts = test::count(test::to_mesh(last));
    EXPECT_TRUE(counts.is_clean());
    EXPECT_TRUE(last.faces.size() == 4 || last.faces.size() == 1) << last.faces.size();
}

TEST(EdgeCollapse, WhatIsNearestToTheRestVanishesFirst) {
    const BlockMesh block = test::free_block(sphere_and_flakes(6));
    ooc::Workers workers(2);
    EdgeCollapse collapse(workers, block, {{}, true});
    collapse.run({});
    std::vector<double> places;
    for (const CollapseStep& step : collapse.steps()) {
        if (step.kept == kNoIndex) places.push_back(block.position(step.gone)[0]);
    }
    EXPECT_EQ(places.size(), 6U);
    EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
}

TEST(EdgeCollapse, LeavesFrozenAndLockedVerticesAlone) {
    BlockMesh block = test::free_block(large(test::cube_sphere(16, 0.02)));
    std::vector<std::pair<VertexId, Vec3>> fixed;
    test::Random random(3);
    for (StoredVertex& v : block.vertices) {
        const std::uint64_t kind = random.below(6);
        if (kind > 1) continue;
        v.flags = kind == 0 ? VertexFlags::kFrozen : VertexFlags::kLocked;
        fixed.emplace_back(v.id, v.vertex.position);
    }
    ooc::Workers workers(2);
    EdgeCollapse collapse(workers, block, {});
    collapse.run({});
    apply_steps(block, collapse.steps(), nullptr);
    EXPECT_LT(block.vertices.size(), 1500U);
    for (const auto& [id, position] : fixed) {
        const std::uint32_t v = find_vertex(block, id);
        ASSERT_LT(v, block.vertices.size());
        EXPECT_EQ(block.vertices[v].id, id);
        EXPECT_EQ(block.position(v), position);
    }
    const test::Counts counts = test::count(test::to_mesh(block));
    EXPECT_TRUE(counts.is_clean() && counts.is_closed());
}

}  // namespace hewer::rsimp
