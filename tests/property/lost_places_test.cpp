// SPDX-License-Identifier: MIT
/// No part goes missing unnoticed: what the output has lost is listed with its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/dust.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

bool is_listed(const LostPlaces& lost, const Vec3& center, double slack) {
    return std::any_of(lost.list.begin(), lost.list.end(), [&](const LostPlace& place) {
        return distance(place.center, center) <= 0.5 * place.size + slack;
    });
}

}  // namespace

TEST(LostPlaces, EveryPartThatIsGoneIsListedWhateverTheMethod) {
    const Dust dust(24, 0.001, 0.08);
    for (const Method method : {Method::Refine, Method::Uniform, Method::Full}) {
        for (const double triangles : {6000.0, 1500.0, 400.0, 60.0}) {
            // Clusters of a hundred cells hold several parts: then parts of three clusters can fold
            // into bubbles that are not told from those of a large part.
            if (triangles < 100 && method != Method::Uniform) continue;
            SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
            options.method = method;
            const Outcome run = run_simplify(dust.mesh, options);
            const LodReport& lod = run.report.lods[0];
            const double cell = run.report.grid.cell_size;
            std::size_t n_gone = 0;
            for (std::size_t i = 0; i < dust.centers.size(); ++i) {
                if (dust.is_in(run.lods[0], i, cell)) continue;
                ++n_gone;
                EXPECT_TRUE(is_listed(lod.lost, dust.centers[i], 2 * cell + dust.radii[i]))
                    << "part " << i << " of radius " << dust.radii[i] << ", method "
                    << static_cast<int>(method) << ", " << triangles << ", cell " << cell;
            }
            if (triangles <= 400 && method != Method::Full) {
                EXPECT_GT(n_gone, 0U);
            }
        }
    }
}

TEST(LostPlaces, OfAThousandPartsNoneGoesUncountedHoweverSmallTheBudget) {
    // Spheres far apart: what is left of one is a closed component, and each that is gone is at a
    // place of its own.
    Mesh mesh;
    Random random(3);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const double r = random.between(0.05, 0.3);
        const std::uint64_t row = i / 10 % 10;
        const std::uint64_t layer = i / 100;
        const Mesh one = translated(
            scaled(cube_sphere(2), {r, r, r}),
            {static_cast<double>(i % 10), static_cast<double>(row), static_cast<double>(layer)});
        const std::uint64_t first = mesh.positions.size();
        mesh.positions.insert(mesh.positions.end(), one.positions.begin(), one.positions.end());
        for (const Triangle& t : one.triangles) {
            mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        }
    }
    for (const Method method : {Method::Refine, Method::Uniform, Method::Full}) {
        for (const double triangles : {4000.0, 1000.0, 40.0}) {
            SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
            options.method = method;
            options.feedback_rounds = 0;
            options.fit_rounds = 0;
            const LodReport lod = run_simplify(mesh, options).report.lods[0];
            EXPECT_GE(lod.topology.components + lod.lost.places, 1000U)
                << static_cast<int>(method) << ", " << triangles;
            EXPECT_EQ(lod.topology.border_edges, 0U);
        }
    }
}

TEST(LostPlaces, OfOneSurfaceNoMoreIsLostThanASpikeOfACell) {
    const Outcome run =
        run_simplify(cube_sphere(40, 0.002), options_for(Target::Kind::Triangles, 1000));
    for (const LostPlace& place : run.report.lods[0].lost.list) {
        EXPECT_LT(place.size, 2 * run.report.grid.cell_size);
    }
}

TEST(LostPlaces, LaterLevelsListWhatEarlierOnesLost) {
    SimplifyOptions options;
    for (const double n : {5000.0, 300.0, 40.0, 4.0}) {
        options.targets.push_back({Target::Kind::Triangles, n});
    }
    const Outcome run = run_simplify(many_spheres(3, 8), options);
    for (std::size_t i = 0; i + 1 < run.report.lods.size(); ++i) {
        EXPECT_LE(run.report.lods[i].lost.cells, run.report.lods[i + 1].lost.cells);
    }
    // 26 spheres of diameter .8 on an integer grid: each is a place of its own.
    const LostPlaces& lost = run.report.lods.back().lost;
    EXPECT_EQ(lost.places, 26U);
    for (const LostPlace& place : lost.list) {
        EXPECT_NEAR(place.size, 0.8 * std::sqrt(3.0), 0.3);
        for (const double x : place.center) EXPECT_NEAR(x, std::round(x), 0.1);
    }
}

TEST(LostPlaces, ThreadsAndMemoryDoNotShow) {
    const Dust dust(60, 0.002, 0.05);
    const auto run_with = [&](unsigned n_threads, std::uint64_t memory, bool spills) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 500);
        options.n_threads = n_threads;
        options.memory_bytes = memory;
        options.tuning.spills_at_once = spills;
        return run_simplify(dust.mesh, options).report.lods[0].lost;
    };
    const LostPlaces expected = run_with(1, std::uint64_t{2} << 30, false);
    EXPECT_GT(expected.places, 0U);
    for (const unsigned n_threads : {2U, 5U}) {
        const LostPlaces lost = run_with(n_threads, std::uint64_t{96} << 20, true);
        EXPECT_EQ(lost.places, expected.places);
        EXPECT_EQ(lost.cells, expected.cells);
        ASSERT_EQ(lost.list.size(), expected.list.size());
        for (std::size_t i = 0; i < lost.list.size(); ++i) {
            EXPECT_EQ(lost.list[i].center, expected.list[i].center);
            EXPECT_EQ(lost.list[i].size, expected.list[i].size);
        }
    }
}

}  // namespace hewer::test
