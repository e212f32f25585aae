// SPDX-License-Identifier: MIT
/// Several levels of detail from one run: each meets its target and nests in the one before.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

// A torus needs 14 triangles; the other shapes of these tests fewer.
constexpr std::size_t kTopologyFloor = 14;
constexpr std::uint64_t kNoParent = std::numeric_limits<std::uint64_t>::max();

/// The triangles of `mesh` with parents in place of its vertices, those left out that collapse.
std::set<Triangle> parent_triangles(const Mesh& mesh, const LodParents& parents) {
    std::vector<Triangle> mapped;
    for (const Triangle& t : mesh.triangles) {
        const Triangle p{parents.at(t[0]), parents.at(t[1]), parents.at(t[2])};
        if (std::find(p.begin(), p.end(), kNoParent) != p.end()) continue;
        if (p[0] != p[1] && p[1] != p[2] && p[0] != p[2]) mapped.push_back(p);
    }
    return triangle_set(mapped);
}

SimplifyOptions chain(Target::Kind kind, const std::vector<double>& values) {
    SimplifyOptions options;
    for (const double value : values) options.targets.push_back({kind, value});
    return options;
}

void expect_nested(const Outcome& run, const std::string& name) {
    ASSERT_EQ(run.parents.size() + 1, run.lods.size()) << name;
    for (std::size_t i = 0; i + 1 < run.lods.size(); ++i) {
        const Mesh& coarse = run.lods[i + 1];
        ASSERT_EQ(run.parents[i].size(), run.lods[i].positions.size()) << name;
        for (const std::uint64_t p : run.parents[i]) {
            EXPECT_TRUE(p == kNoParent || p < coarse.positions.size()) << name;
        }
        // Only levels below what the topology allows may be built otherwise, and they say so.
        if (!run.report.lods[i + 1].is_nested) {
            EXPECT_LT(coarse.triangles.size(), kTopologyFloor) << name << ", level " << i + 1;
            continue;
        }
        EXPECT_EQ(parent_triangles(run.lods[i], run.parents[i]), triangle_set(coarse.triangles))
            << name << ", level " << i;
    }
}

}  // namespace

TEST(LodChain, EveryLevelMeetsItsTargetAndNests) {
    const std::vector<double> targets{2000, 1000, 333, 60, 12};
    for (const auto& [name, mesh] :
         {std::pair{"sphere", cube_sphere(30, 0.03)}, std::pair{"torus", torus(120, 50)},
          std::pair{"plane", plane_grid(60, 0.01)}, std::pair{"book", book(4, 25)},
          std::pair{"strip", moebius_strip(200, 12)}}) {
        const Outcome run = run_simplify(mesh, chain(Target::Kind::Triangles, targets));
        ASSERT_EQ(run.lods.size(), targets.size());
        for (std::size_t i = 0; i < targets.size(); ++i) {
            const auto n = static_cast<double>(run.lods[i].triangles.size());
            EXPECT_LE(n, targets[i]) << name;
            if (targets[i] >= 60) {
                EXPECT_GE(n, 0.99 * targets[i] - 1) << name;
            }
            EXPECT_TRUE(count(run.lods[i]).is_clean()) << name;
        }
        expect_nested(run, name);
    }
}

TEST(LodChain, VerticesOfDroppedPartsHaveNoParent) {
    const Outcome run =
        run_simplify(many_spheres(3, 8), chain(Target::Kind::Triangles, {5000, 300, 40, 4}));
    expect_nested(run, "spheres");
    const auto& last = run.parents.back();
    EXPECT_GT(std::count(last.begin(), last.end(), kNoParent), 0);
    EXPECT_EQ(run.lods.back().triangles.size(), 4U);
    EXPECT_GT(run.report.lods.back().lost_cells, 0U);
}

TEST(LodChain, ErrorBoundsRiseAndNest) {
    const Outcome run =
        run_simplify(torus(300, 120), chain(Target::Kind::RelativeError, {0.005, 0.02, 0.08}));
    expect_nested(run, "torus");
    for (std::size_t i = 0; i + 1 < run.lods.size(); ++i) {
        EXPECT_GT(run.lods[i].triangles.size(), run.lods[i + 1].triangles.size());
        EXPECT_LT(run.report.lods[i].error_bound, run.report.lods[i + 1].error_bound);
    }
}

TEST(LodChain, RatiosAndVerticesMakeChainsToo) {
    const Mesh mesh = cube_sphere(30, 0.03);
    const Outcome ratios = run_simplify(mesh, chain(Target::Kind::Ratio, {0.5, 0.1, 0.02}));
    EXPECT_EQ(ratios.lods[0].triangles.size(), 5400U);
    EXPECT_EQ(ratios.lods[1].triangles.size(), 1080U);
    EXPECT_EQ(ratios.lods[2].triangles.size(), 216U);
    expect_nested(ratios, "ratios");
    const Outcome vertices = run_simplify(mesh, chain(Target::Kind::Vertices, {1000, 100, 10}));
    EXPECT_EQ(vertices.lods[0].positions.size(), 1000U);
    EXPECT_EQ(vertices.lods[1].positions.size(), 100U);
    EXPECT_EQ(vertices.lods[2].positions.size(), 10U);
    expect_nested(vertices, "vertices");
}

}  // namespace hewer::test
