// SPDX-License-Identifier: MIT
#include "rsimp/manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/face_components.h"
#include "rsimp/half_edges.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/block_meshes.h"

namespace hewer::rsimp {

namespace {

struct Built {
    std::vector<Triangle> triangles;
    std::vector<std::uint64_t> clusters;
    test::Counts counts;
    ManifoldCounts made;
};

Built build(const Mesh& mesh, bool is_closed) {
    BlockMesh block = test::raw_block(mesh);
    Built built;
    built.made = make_manifold(block, {is_closed, false});
    for (const LocalFace& t : block.faces) built.triangles.push_back({t[0], t[1], t[2]});
    for (const StoredVertex& v : block.vertices) {
        EXPECT_TRUE(VertexFlags::is_free(v.flags));
        built.clusters.push_back(cluster_of(v.id));
    }
    EXPECT_TRUE(
        std::is_sorted(block.vertices.begin(), block.vertices.end(),
                       [](const StoredVertex& a, const StoredVertex& b) { return a.id < b.id; }));
    built.counts = test::count(built.triangles, built.clusters.size());
    return built;
}

/// Every vertex becomes one of `n` places at random: the surface is folded onto itself badly.
Mesh merged_at_random(Mesh mesh, std::uint64_t n, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<std::uint64_t> place;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) place.push_back(random.below(n));
    mesh.positions.resize(n);
    for (Triangle& t : mesh.triangles) t = {place[t[0]], place[t[1]], place[t[2]]};
    return mesh;
}

}  // namespace

TEST(MakeManifold, LeavesAManifoldMeshAsItIs) {
    for (const Mesh& mesh : {test::cube_sphere(12, 0.02), test::torus(30, 12)}) {
        const Built built = build(mesh, true);
        std::vector<Triangle> as_clusters;
        for (const Triangle& t : built.triangles) {
            as_clusters.push_back(
                {built.clusters[t[0]], built.clusters[t[1]], built.clusters[t[2]]});
        }
        EXPECT_EQ(test::triangle_set(as_clusters), test::triangle_set(mesh.triangles));
        EXPECT_EQ(built.clusters.size(), mesh.positions.size());
        EXPECT_EQ(built.made.cancelled_faces, 0U);
        EXPECT_EQ(built.made.cut_vertices, 0U);
    }
}

TEST(MakeManifold, ClosedStaysClosedHoweverItIsFolded) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        for (const std::uint64_t n : {5U, 20U, 100U, 600U}) {
            const Built built = build(merged_at_random(test::cube_sphere(10, 0.1), n, seed), true);
            EXPECT_TRUE(built.counts.is_closed()) << n << ", " << seed;
            EXPECT_TRUE(built.counts.is_clean())
                << n << ", " << seed << ": " << built.counts.duplicates << ' '
                << built.counts.split_fans << ' ' << built.counts.unreferenced;
            EXPECT_EQ(built.counts.unlike_edges, 0U) << n << ", " << seed;
        }
    }
}

TEST(MakeManifold, OpenAndDirtyInputsKeepNoEdgeOfMoreThanTwoFaces) {
    std::vector<Mesh> meshes{test::book(3, 6), test::book(8, 6), test::moebius_strip(40, 5),
                             test::with_turned_triangles(test::cube_sphere(10), 0.4, 2)};
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        meshes.push_back(test::random_soup(8, 200, seed));
        meshes.push_back(test::random_soup(100, 1000, seed));
        meshes.push_back(merged_at_random(test::plane_grid(20, 0.02), 150, seed));
    }
    for (const Mesh& mesh : meshes) {
        const Built built = build(mesh, false);
        EXPECT_EQ(built.counts.nonmanifold_edges, 0U);
        EXPECT_EQ(built.counts.degenerate, 0U);
        // A face may meet its opposite, as a sheet folded onto itself, but never its like.
        EXPECT_EQ(test::triangle_set(built.triangles).size(), built.triangles.size());
        EXPECT_EQ(built.counts.split_fans, 0U);
        EXPECT_EQ(built.counts.unreferenced, 0U);
        EXPECT_FALSE(built.triangles.empty());
        for (const std::uint64_t c : built.clusters) EXPECT_LT(c, mesh.positions.size());
    }
}

TEST(MakeManifold, ABookIsTakenApartWithoutLosingAPage) {
    for (const std::uint64_t n_pages : {3U, 4U, 7U}) {
        const Mesh mesh = test::book(n_pages, 5);
        const Built built = build(mesh, false);
        EXPECT_EQ(built.triangles.size(), mesh.triangles.size());
        EXPECT_GT(built.made.cut_vertices, 0U);
        EXPECT_GT(built.clusters.size(), mesh.positions.size());
    }
}

TEST(MakeManifold, VerticesThatAreTakenApartStayWhereTheyWere) {
    // Two triangles that touch in one corner, from a few cells to a country large.
    for (const double size : {4.0, 1e3, 1e6}) {
        Mesh mesh;
        mesh.positions = {
            {size, size, 7}, {0, size, 7}, {size, 0, 7}, {2 * size, size, 7}, {size, 2 * size, 7}};
        mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
        BlockMesh block = test::raw_block(mesh);
        EXPECT_EQ(make_manifold(block, {false, false}).cut_vertices, 1U);
        ASSERT_EQ(block.vertices.size(), 6U);
        for (const StoredVertex& v : block.vertices) {
            const Vec3 step = v.vertex.position - mesh.positions[cluster_of(v.id)];
            EXPECT_LE(std::sqrt(dot(step, step)), 0.25 + 1e-9) << "size " << size;
        }
        EXPECT_NE(block.position(0), block.position(1)) << "two sheets would touch";
    }
}

TEST(MakeManifold, FoldingOpensNothingBesideABorder) {
    // A hole of one triangle has three border edges, whatever is merged.
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Mesh mesh = test::cube_sphere(10, 0.1);
        mesh.triangles.erase(mesh.triangles.begin() + 100);
        for (const std::uint64_t n : {100U, 300U, 600U}) {
            const Built built = build(merged_at_random(mesh, n, seed), false);
            EXPECT_LE(built.counts.border_edges, 3U) << n << ", " << seed;
            EXPECT_EQ(built.counts.nonmanifold_edges, 0U) << n << ", " << seed;
        }
    }
}

TEST(MakeManifold, AFewDuplicatesInAnOpenMeshAreDirt) {
    Mesh mesh = test::plane_grid(20);
    const std::size_t n = mesh.triangles.size();
    for (const std::size_t i : {50U, 51U, 300U, 301U, 302U, 500U}) {
        mesh.triangles.push_back(mesh.triangles[i]);
    }
    const Built built = build(mesh, false);
    EXPECT_EQ(built.triangles.size(), n);
    EXPECT_EQ(built.counts.border_edges, 80U);
    EXPECT_TRUE(built.counts.is_clean());
}

TEST(MakeManifold, DuplicatesInAnOpenMeshAreDirt) {
    Mesh mesh = test::plane_grid(8);
    const std::size_t n = mesh.triangles.size();
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(),
                          mesh.triangles.begin() + 20);
    const Built built = build(mesh, false);
    EXPECT_EQ(built.triangles.size(), n);
    EXPECT_EQ(built.made.cancelled_faces, 20U);
}

TEST(MakeManifold, TriplesWithRepeatedIdsAreSkipped) {
    Mesh mesh = test::cube_sphere(5);
    const std::size_t n = mesh.triangles.size();
    mesh.triangles.insert(mesh.triangles.begin() + 7, {{1, 1, 2}, {3, 4, 3}, {5, 5, 5}});
    EXPECT_EQ(build(mesh, true).triangles.size(), n);
}

TEST(MakeManifold, TheOrderOfTheFacesDoesNotShow) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (const bool is_closed : {true, false}) {
            Mesh mesh = is_closed
                            ? merged_at_random(test::cube_sphere(10, 0.1), 150, seed)
                            : test::joined(test::book(5, 6), test::random_soup(60, 500, seed));
            const Built expected = build(mesh, is_closed);
            test::Random random(seed);
            for (std::size_t i = mesh.triangles.size(); i > 1; --i) {
                std::swap(mesh.triangles[i - 1], mesh.triangles[random.below(i)]);
            }
            for (Triangle& t : mesh.triangles) {
                std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)),
                            t.end());
            }
            const Built built = build(mesh, is_closed);
            EXPECT_EQ(built.triangles, expected.triangles);
            EXPECT_EQ(built.clusters, expected.clusters);
        }
    }
}

TEST(MakeManifold, LeavesFrozenClustersForLater) {
    // Frozen at random: what is free is manifold around itself; freezing nothing afterwards makes
    // the rest so, too.
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        BlockMesh block = test::raw_block(merged_at_random(test::cube_sphere(10, 0.1), 200, seed));
        test::Random random(seed);
        for (StoredVertex& v : block.vertices) {
            if (random.below(3) == 0) v.flags |= VertexFlags::kFrozen;
        }
        make_manifold(block, {true, false});
        std::vector<int> n_open(block.vertices.size());
        for_each_edge(block.faces, block.vertices.size(),
                      [&](std::uint32_t low, std::span<const HalfEdge> group) {
                          const std::uint32_t high = group[0].other;
                          if (block.is_free(low) || block.is_free(high)) {
                              EXPECT_EQ(group.size(), 2U);
                          }
                      });
        for (StoredVertex& v : block.vertices) v.flags &= ~VertexFlags::kFrozen;
        make_manifold(block, {true, false});
        const test::Counts counts = test::count(test::to_mesh(block));
        EXPECT_TRUE(counts.is_closed()) << seed;
        EXPECT_TRUE(counts.is_clean()) << seed;
    }
}

namespace {

/// Two spheres that share a vertex of one, as if a neck of `n_cells` vertices had shrunk to it.
BlockMesh hourglass(std::uint32_t n_cells, std::uint64_t side = 6) {
    Mesh mesh = test::cube_sphere(side);
    const std::size_t n = mesh.positions.size();
    mesh = test::joined(mesh, test::translated(test::cube_sphere(side), {2, 0, 0}));
    std::size_t right = 0;
    std::size_t left = n;
    for (std::size_t v = 0; v < n; ++v) {
        if (mesh.positions[v][0] > mesh.positions[right][0]) right = v;
        if (mesh.positions[n + v][0] < mesh.positions[left][0]) left = n + v;
    }
    for (Triangle& t : mesh.triangles) std::replace(t.begin(), t.end(), left, right);
    mesh.positions[left] = mesh.positions.back();
    for (Triangle& t : mesh.triangles) std::replace(t.begin(), t.end(), 2 * n - 1, left);
    mesh.positions.pop_back();
    BlockMesh block = test::raw_block(mesh);
    block.vertices[right].n_cells = n_cells;
    return block;
}

std::uint64_t count_components(const BlockMesh& block) {
    const std::vector<std::uint32_t> label = component_labels(block.vertices.size(), block.faces);
    std::uint64_t n = 0;
    for (std::uint32_t v = 0; v < label.size(); ++v) n += label[v] == v ? 1U : 0U;
    return n;
}

constexpr SurfaceKind kClosedOfVertices{true, true};

}  // namespace

TEST(MakeManifold, WhatANeckHeldTogetherStaysTogether) {
    BlockMesh block = hourglass(2);
    const std::size_t n_faces = block.faces.size();
    EXPECT_EQ(make_manifold(block, kClosedOfVertices).joined_necks, 1U);
    EXPECT_EQ(count_components(block), 1U);
    EXPECT_EQ(block.faces.size(), n_faces + 4);
    const test::Counts counts = test::count(test::to_mesh(block));
    EXPECT_TRUE(counts.is_closed());
    EXPECT_TRUE(counts.is_clean());
    EXPECT_EQ(counts.unlike_edges, 0U);
    EXPECT_EQ(block.vertices.size() + block.faces.size() - 3 * block.faces.size() / 2, 2U)
        << "a sphere";
}

TEST(MakeManifold, SurfacesThatTouchInOneVertexOfTheInputComeApart) {
    BlockMesh block = hourglass(1);
    EXPECT_EQ(make_manifold(block, kClosedOfVertices).joined_necks, 0U);
    EXPECT_EQ(count_components(block), 2U);
    BlockMesh cells = hourglass(2);
    EXPECT_EQ(make_manifold(cells, {true, false}).joined_necks, 0U) << "cells join what is near";
}

TEST(MakeManifold, PartsThatReachIntoOtherBlocksMayHangTogetherThere) {
    for (const bool is_other_frozen : {false, true}) {
        BlockMesh block = hourglass(2);
        block.vertices.back().flags |= VertexFlags::kFrozen;
        if (is_other_frozen) block.vertices.front().flags |= VertexFlags::kFrozen;
        EXPECT_EQ(make_manifold(block, kClosedOfVertices).joined_necks, is_other_frozen ? 0U : 1U);
        EXPECT_EQ(count_components(block), is_other_frozen ? 2U : 1U);
    }
}

TEST(MakeManifold, NoTwoPartsShareAClusterOfAFoldedSurface) {
    std::uint64_t n_joined = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        for (const std::uint64_t n : {1000U, 4000U, 5800U}) {
            BlockMesh block = test::raw_block(merged_at_random(test::many_spheres(3, 6), n, seed));
            for (StoredVertex& v : block.vertices) v.n_cells = 2;
            n_joined += make_manifold(block, kClosedOfVertices).joined_necks;
            const test::Counts counts = test::count(test::to_mesh(block));
            EXPECT_TRUE(counts.is_closed()) << n << ", " << seed;
            EXPECT_TRUE(counts.is_clean()) << n << ", " << seed;
            EXPECT_EQ(counts.unlike_edges, 0U) << n << ", " << seed;
            const auto label = component_labels(block.vertices.size(), block.faces);
            for (std::size_t v = 1; v < label.size(); ++v) {
                if (cluster_of(block.vertices[v].id) == cluster_of(block.vertices[v - 1].id)) {
                    EXPECT_EQ(label[v], label[v - 1]) << n << ", " << seed;
                }
            }
        }
    }
    EXPECT_GT(n_joined, 0U);
}

TEST(MakeManifold, WhatIsAllNecksIsNotHeldTogether) {
    constexpr std::uint32_t kHourglasses = 60;
    const BlockMesh one = hourglass(2, 3);
    BlockMesh all;
    for (std::uint32_t k = 0; k < kHourglasses; ++k) {
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        for (StoredVertex v : one.vertices) {
            v.id = vertex_id(all.vertices.size(), 0);
            all.vertices.push_back(v);
        }
        for (const LocalFace& t : one.faces) {
            all.faces.push_back({t[0] + first, t[1] + first, t[2] + first});
        }
    }
    const std::uint64_t most = all.faces.size() / 400;
    ASSERT_LT(most, kHourglasses);
    EXPECT_EQ(make_manifold(all, kClosedOfVertices).joined_necks, most);
    EXPECT_EQ(count_components(all), 2 * kHourglasses - most);
}

TEST(CountEdges, AgreesWithAPlainCount) {
    for (const Mesh& mesh : {test::cube_sphere(8), test::plane_grid(9), test::book(5, 6),
                             test::random_soup(40, 300, 1)}) {
        std::vector<LocalFace> faces;
        std::vector<Triangle> plain;
        for (const Triangle& t : mesh.triangles) {
            if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
            plain.push_back(t);
            faces.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                             static_cast<std::uint32_t>(t[2])});
        }
        const EdgeCounts counts = count_edges(faces, mesh.positions.size());
        const test::Counts expected = test::count(plain, mesh.positions.size());
        EXPECT_EQ(counts.edges, expected.edges);
        EXPECT_EQ(counts.border, expected.border_edges);
        EXPECT_EQ(counts.nonmanifold, expected.nonmanifold_edges);
    }
}

}  // namespace hewer::rsimp
