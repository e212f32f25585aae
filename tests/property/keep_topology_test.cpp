// SPDX-License-Identifier: MIT
/// --topology keep: components, handles and border loops of the input stay, or there is no result.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/topology_limit.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

SimplifyOptions keeping(const std::vector<double>& triangles) {
    SimplifyOptions options;
    for (const double n : triangles) options.targets.push_back({Target::Kind::Triangles, n});
    options.topology = Topology::Keep;
    return options;
}

/// The boundary of unit cubes at whole places, each side n x n squares.
Mesh block_surface(const std::vector<std::array<int, 3>>& cubes, int n) {
    const auto has = [&](const std::array<int, 3>& c) {
        return std::find(cubes.begin(), cubes.end(), c) != cubes.end();
    };
    Mesh mesh;
    std::map<std::array<int, 3>, std::uint64_t> ids;
    const auto vertex = [&](const std::array<int, 3>& p) {
        const auto [at, is_new] = ids.try_emplace(p, mesh.positions.size());
        if (is_new) {
            mesh.positions.push_back({1.0 * p[0] / n, 1.0 * p[1] / n, 1.0 * p[2] / n});
        }
        return at->second;
    };
    for (const auto& c : cubes) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const int side : {0, 1}) {
                auto beyond = c;
                beyond[axis] += side == 1 ? 1 : -1;
                if (has(beyond)) continue;
                const std::size_t u = (axis + 1) % 3;
                const std::size_t v = (axis + 2) % 3;
                for (int i = 0; i < n; ++i) {
                    for (int j = 0; j < n; ++j) {
                        const auto corner = [&](int a, int b) {
                            std::array<int, 3> p{};
                            p[axis] = n * (c[axis] + side);
                            p[u] = n * c[u] + i + a;
                            p[v] = n * c[v] + j + b;
                            return vertex(p);
                        };
                        const std::array<std::uint64_t, 4> q{corner(0, 0), corner(1, 0),
                                                             corner(1, 1), corner(0, 1)};
                        if (side == 1) {
                            mesh.triangles.push_back({q[0], q[1], q[2]});
                            mesh.triangles.push_back({q[0], q[2], q[3]});
                        } else {
                            mesh.triangles.push_back({q[0], q[2], q[1]});
                            mesh.triangles.push_back({q[0], q[3], q[2]});
                        }
                    }
                }
            }
        }
    }
    return mesh;
}

/// A plate with `k` holes through it.
Mesh plate_with_handles(int k, int n) {
    std::vector<std::array<int, 3>> cubes;
    for (int x = 0; x < 2 * k + 1; ++x) {
        for (int y = 0; y < 3; ++y) {
            if (y != 1 || x % 2 == 0) cubes.push_back({x, y, 0});
        }
    }
    return block_surface(cubes, n);
}

/// plane_grid with one triangle in every ninth square missing.
Mesh plane_with_holes(std::uint64_t n) {
    Mesh mesh = plane_grid(n, 0.01);
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::size_t square = t / 2;
        const bool is_hole = t % 2 == 0 && square % n % 6 == 3 && square / n % 6 == 3;
        if (!is_hole) kept.push_back(mesh.triangles[t]);
    }
    mesh.triangles = kept;
    return mesh;
}

void expect_same(const Counts& before, const LodReport& lod, const Mesh& after) {
    const Counts counts = count(after);
    EXPECT_EQ(counts.euler, before.euler);
    EXPECT_EQ(counts.border_loops, before.border_loops);
    EXPECT_TRUE(counts.is_clean());
    EXPECT_EQ(lod.topology.euler, before.euler);
    EXPECT_LE(lod.triangles, lod.target_triangles);
}

}  // namespace

TEST(KeepTopology, HandlesHolesAndComponentsStayAtEveryLevel) {
    struct Case {
        const char* name;
        Mesh mesh;
        std::uint64_t n_components;
        std::vector<double> triangles;
    };
    const std::vector<Case> cases{
        {"torus", torus(40, 20), 1, {400, 60}},
        {"handles", plate_with_handles(4, 4), 1, {600, 150}},
        {"spheres", many_spheres(3, 4), 27, {1000, 270}},
        {"holes", plane_with_holes(30), 1, {600, 200}},
        {"sheets", two_sheets(20, 1e-4), 2, {200, 20}},
        {"strip", moebius_strip(60, 4), 1, {200, 40}},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const Outcome run = run_simplify(c.mesh, keeping(c.triangles));
        const Counts before = count(c.mesh);
        for (std::size_t i = 0; i < run.lods.size(); ++i) {
            expect_same(before, run.report.lods[i], run.lods[i]);
            EXPECT_EQ(run.report.lods[i].topology.components, c.n_components);
            EXPECT_EQ(run.report.lods[i].lost.places, 0U);
        }
        ASSERT_TRUE(run.report.kept_topology);
        EXPECT_EQ(run.report.kept_topology->components, c.n_components);
        EXPECT_TRUE(run.report.warnings.empty());
    }
}

TEST(KeepTopology, ATargetBelowIsRefusedWithOneThatIsMet) {
    const Mesh mesh = many_spheres(3, 4);
    std::uint64_t least = 0;
    try {
        run_simplify(mesh, keeping({1000, 60}));
        FAIL() << "27 spheres in 60 triangles";
    } catch (const TopologyLimit& limit) {
        least = limit.least_triangles();
        EXPECT_NE(std::string(limit.what()).find(std::to_string(least) + " triangles"),
                  std::string::npos);
    }
    // A closed component has four at least.
    EXPECT_GE(least, 27U * 4);
    EXPECT_LE(least, 27U * 8);
    const Outcome run = run_simplify(mesh, keeping({static_cast<double>(least)}));
    EXPECT_EQ(run.report.lods[0].triangles, least);
    EXPECT_EQ(run.report.lods[0].topology.components, 27U);
}

TEST(KeepTopology, WhatIsNotManifoldIsTakenApartFirstAndAWarningSaysSo) {
    const Outcome run = run_simplify(book(5, 8), keeping({100}));
    ASSERT_TRUE(run.report.kept_topology);
    EXPECT_EQ(run.report.kept_topology->nonmanifold_edges, 0U);
    EXPECT_EQ(run.report.lods[0].topology.euler, run.report.kept_topology->euler);
    ASSERT_EQ(run.report.warnings.size(), 1U);
    EXPECT_NE(run.report.warnings[0].find("that is what is kept"), std::string::npos);
}

TEST(KeepTopology, VerticesOfEqualPositionsAreOne) {
    Mesh split;
    const Mesh whole = torus(24, 12);
    for (const Triangle& t : whole.triangles) {
        const std::uint64_t first = split.positions.size();
        for (const std::uint64_t v : t) split.positions.push_back(whole.positions[v]);
        split.triangles.push_back({first, first + 1, first + 2});
    }
    const Outcome run = run_simplify(split, keeping({100}));
    EXPECT_EQ(run.report.lods[0].topology.components, 1U);
    EXPECT_EQ(run.report.lods[0].topology.border_edges, 0U);
    EXPECT_EQ(run.report.lods[0].topology.euler, 0);
}

TEST(KeepTopology, ABoundOnDisplacementsIsMetAsFarAsTopologyAllows) {
    SimplifyOptions options = options_for(Target::Kind::Error, 0.05);
    options.topology = Topology::Keep;
    const Outcome run = run_simplify(torus(60, 30), options);
    EXPECT_EQ(run.report.lods[0].topology.euler, 0);
    EXPECT_LE(run.report.lods[0].error_bound, 0.05 * (1 + 1e-9));
    EXPECT_LT(run.report.lods[0].triangles, 3600U * 2 / 3);
}

TEST(KeepTopology, OtherMethodsAndWhatChangesPartsAreRefused) {
    const Mesh mesh = torus(10, 6);
    for (const Method method : {Method::Refine, Method::Uniform}) {
        SimplifyOptions options = keeping({50});
        options.method = method;
        EXPECT_THROW(run_simplify(mesh, options), InvalidArgument);
    }
    for (const int which : {0, 1, 2}) {
        SimplifyOptions options = keeping({50});
        const Target length{Target::Kind::Error, 0.1};
        if (which == 0) options.cell_size = 0.1;
        if (which == 1) options.drop_parts = length;
        if (which == 2) options.aggregate = length;
        EXPECT_THROW(run_simplify(mesh, options), InvalidArgument);
    }
}

TEST(KeepTopology, ThreadsAndMemoryDoNotShow) {
    const Mesh mesh = many_spheres(3, 6);
    const auto run_with = [&](unsigned n_threads, std::uint64_t memory, bool spills) {
        SimplifyOptions options = keeping({2000, 400});
        options.n_threads = n_threads;
        options.memory_bytes = memory;
        options.tuning.spills_at_once = spills;
        return run_simplify(mesh, options).report.result_hash;
    };
    const std::string expected = run_with(1, std::uint64_t{2} << 30, false);
    EXPECT_EQ(run_with(2, std::uint64_t{96} << 20, true), expected);
    EXPECT_EQ(run_with(5, std::uint64_t{96} << 20, true), expected);
}

}  // namespace hewer::test
