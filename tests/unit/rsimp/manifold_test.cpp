// SPDX-License-Identifier: MIT
#include "rsimp/manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "tests/support/clustered_mesh.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

struct Built {
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> clusters;
    test::Counts counts;
    std::uint64_t n_cancelled = 0;
    std::uint64_t n_cut_vertices = 0;
};

Built build(const Mesh& mesh, bool is_closed, unsigned n_threads = 2) {
    const auto context = test::make_context(n_threads);
    std::vector<CellTriple> triples;
    for (const Triangle& t : mesh.triangles) {
        triples.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                           static_cast<std::uint32_t>(t[2])});
    }
    const ManifoldMesh manifold = build_manifold(*context, triples, mesh.positions, is_closed);
    Built built;
    for (const CellTriple& t : manifold.triangles) built.triangles.push_back({t[0], t[1], t[2]});
    built.clusters.assign(manifold.cluster_of_vertex.begin(), manifold.cluster_of_vertex.end());
    built.counts = test::count(built.triangles, built.clusters.size());
    built.n_cancelled = manifold.n_cancelled;
    built.n_cut_vertices = manifold.n_cut_vertices;
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

TEST(BuildManifold, LeavesAManifoldMeshAsItIs) {
    for (const Mesh& mesh : {test::cube_sphere(12, 0.02), test::torus(30, 12)}) {
        const Built built = build(mesh, true);
        std::vector<Triangle> as_clusters;
        for (const Triangle& t : built.triangles) {
            as_clusters.push_back(
                {built.clusters[t[0]], built.clusters[t[1]], built.clusters[t[2]]});
        }
        EXPECT_EQ(test::triangle_set(as_clusters), test::triangle_set(mesh.triangles));
        EXPECT_EQ(built.clusters.size(), mesh.positions.size());
        EXPECT_EQ(built.n_cancelled, 0U);
        EXPECT_EQ(built.n_cut_vertices, 0U);
    }
}

TEST(BuildManifold, ClosedStaysClosedHoweverItIsFolded) {
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

TEST(BuildManifold, OpenAndDirtyInputsKeepNoEdgeOfMoreThanTwoFaces) {
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
        for (const std::uint32_t c : built.clusters) EXPECT_LT(c, mesh.positions.size());
    }
}

TEST(BuildManifold, ABookIsTakenApartWithoutLosingAPage) {
    for (const std::uint64_t n_pages : {3U, 4U, 7U}) {
        const Mesh mesh = test::book(n_pages, 5);
        const Built built = build(mesh, false);
        EXPECT_EQ(built.triangles.size(), mesh.triangles.size());
        EXPECT_GT(built.n_cut_vertices, 0U);
        EXPECT_GT(built.clusters.size(), mesh.positions.size());
    }
}

TEST(BuildManifold, DuplicatesInAnOpenMeshAreDirt) {
    Mesh mesh = test::plane_grid(8);
    const std::size_t n = mesh.triangles.size();
    mesh.triangles.insert(mesh.triangles.end(), mesh.triangles.begin(),
                          mesh.triangles.begin() + 20);
    const Built built = build(mesh, false);
    EXPECT_EQ(built.triangles.size(), n);
    EXPECT_EQ(built.n_cancelled, 20U);
}

TEST(BuildManifold, TriplesWithRepeatedIdsAreSkipped) {
    Mesh mesh = test::cube_sphere(5);
    const std::size_t n = mesh.triangles.size();
    mesh.triangles.insert(mesh.triangles.begin() + 7, {{1, 1, 2}, {3, 4, 3}, {5, 5, 5}});
    EXPECT_EQ(build(mesh, true).triangles.size(), n);
}

TEST(BuildManifold, NeitherOrderNorThreadsShow) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        for (const bool is_closed : {true, false}) {
            Mesh mesh = is_closed
                            ? merged_at_random(test::cube_sphere(10, 0.1), 150, seed)
                            : test::joined(test::book(5, 6), test::random_soup(60, 500, seed));
            const Built expected = build(mesh, is_closed, 1);
            test::Random random(seed);
            for (std::size_t i = mesh.triangles.size(); i > 1; --i) {
                std::swap(mesh.triangles[i - 1], mesh.triangles[random.below(i)]);
            }
            for (Triangle& t : mesh.triangles) {
                std::rotate(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(random.below(3)),
                            t.end());
            }
            for (const unsigned n_threads : {1U, 8U}) {
                const Built built = build(mesh, is_closed, n_threads);
                EXPECT_EQ(built.triangles, expected.triangles);
                EXPECT_EQ(built.clusters, expected.clusters);
            }
        }
    }
}

TEST(CountEdges, AgreesWithAPlainCount) {
    const auto context = test::make_context();
    for (const Mesh& mesh : {test::cube_sphere(8), test::plane_grid(9), test::book(5, 6),
                             test::random_soup(40, 300, 1)}) {
        std::vector<CellTriple> triples;
        std::vector<Triangle> plain;
        for (const Triangle& t : mesh.triangles) {
            if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
            plain.push_back(t);
            triples.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                               static_cast<std::uint32_t>(t[2])});
        }
        const EdgeCounts counts = count_edges(*context, triples, mesh.positions.size());
        const test::Counts expected = test::count(plain, mesh.positions.size());
        EXPECT_EQ(counts.edges, expected.edges);
        EXPECT_EQ(counts.border, expected.border_edges);
        EXPECT_EQ(counts.nonmanifold, expected.nonmanifold_edges);
    }
}

}  // namespace hewer::rsimp
