// SPDX-License-Identifier: MIT
/// --aggregate: parts that are close to each other are joined, others are not.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/measure.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

SimplifyOptions joining(double triangles, double distance) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
    options.aggregate = Target{Target::Kind::Error, distance};
    return options;
}

/// Cubes of size 1 with their corners shared, `gap` apart, k * k in each layer.
Mesh crowd(std::uint64_t k, double gap, std::uint64_t n_layers) {
    const Mesh one = translated(scaled(cube(1), {0.5, 0.5, 0.5}), {0.5, 0.5, 0.5});
    Mesh mesh;
    for (std::uint64_t i = 0; i < k * k * n_layers; ++i) {
        const std::uint64_t first = mesh.positions.size();
        const std::uint64_t row = i / k % k;
        const std::uint64_t layer = i / k / k;
        const Vec3 at{static_cast<double>(i % k), static_cast<double>(row),
                      static_cast<double>(layer)};
        for (const Vec3& p : one.positions) {
            Vec3 moved;
            for (std::size_t axis = 0; axis < 3; ++axis)
                moved[axis] = p[axis] + (1 + gap) * at[axis];
            mesh.positions.push_back(moved);
        }
        for (const Triangle& t : one.triangles) {
            mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        }
    }
    return mesh;
}

MeasureReport measured(const Mesh& before, const Mesh& after) {
    const auto original = view_mesh(before);
    const auto simplified = view_mesh(after);
    MeasureOptions options;
    options.n_samples = 20'000;
    return measure(*original, *simplified, options);
}

}  // namespace

TEST(Aggregate, PlatesSideBySideAreJoinedAcrossTheGapOrNot) {
    const Mesh plates = joined(plane_grid(16), translated(plane_grid(16), {1.1, 0, 0}));
    for (const Method method : {Method::Full, Method::Refine}) {
        for (const double triangles : {500.0, 100.0}) {
            SimplifyOptions options = joining(triangles, 0.2);
            options.method = method;
            const Outcome one = run_simplify(plates, options);
            EXPECT_EQ(one.report.lods[0].topology.components, 1U);
            EXPECT_EQ(one.report.lods[0].topology.border_loops, 1U);
            EXPECT_EQ(one.report.aggregate->parts, 2U);
            EXPECT_EQ(one.report.aggregate->joined_parts, 1U);
            EXPECT_LE(one.report.aggregate->distance, 0.2);
            options.aggregate->value = 0.05;
            const Outcome two = run_simplify(plates, options);
            EXPECT_EQ(two.report.lods[0].topology.components, 2U);
            EXPECT_EQ(two.report.aggregate->joined_parts, 2U);
        }
    }
}

TEST(Aggregate, WallsThatFaceEachOtherGo) {
    const Mesh two = joined(cube(6), translated(cube(6), {2.1, 0, 0}));
    const Outcome run = run_simplify(two, joining(200, 0.2));
    const LodReport& lod = run.report.lods[0];
    EXPECT_EQ(lod.topology.components, 1U);
    EXPECT_EQ(lod.topology.border_edges, 0U);
    EXPECT_EQ(lod.topology.euler, 2);
    // Nothing is left in the middle, where the walls were.
    for (const Vec3& p : run.lods[0].positions) {
        const bool is_inside =
            p[0] > 0.9 && p[0] < 1.2 && std::abs(p[1]) < 0.9 && std::abs(p[2]) < 0.9;
        EXPECT_FALSE(is_inside);
    }
}

TEST(Aggregate, AtASmallBudgetACrowdIsCloserThanWithout) {
    // One layer: of a filled block the walls inside go, and are far from what is left.
    const Mesh mesh = crowd(15, 0.1, 1);
    for (const double triangles : {400.0, 100.0}) {
        SimplifyOptions options = joining(triangles, 0.2);
        const Outcome with = run_simplify(mesh, options);
        options.aggregate.reset();
        const Outcome without = run_simplify(mesh, options);
        const MeasureReport near = measured(mesh, with.lods[0]);
        const MeasureReport far = measured(mesh, without.lods[0]);
        EXPECT_EQ(with.report.aggregate->joined_parts, 1U);
        EXPECT_LT(near.forward.rms, 0.7 * far.forward.rms);
        EXPECT_EQ(with.report.lods[0].topology.border_edges, 0U);
    }
}

TEST(Aggregate, WhereEightPartsMeetTheirCornersBecomeOne) {
    const Outcome run = run_simplify(crowd(4, 0.1, 4), joining(384, 0.2));
    EXPECT_EQ(run.report.aggregate->merged_cells, 4U * 4 * 4 * 8 - 5 * 5 * 5);
    // One box: its inside is gone.
    EXPECT_EQ(run.report.lods[0].topology.components, 1U);
    EXPECT_EQ(run.report.lods[0].topology.euler, 2);
}

TEST(Aggregate, WhereNothingIsCloseNothingChanges) {
    const Mesh mesh = many_spheres(2, 6);
    SimplifyOptions options = joining(300, 0.1);
    const Outcome run = run_simplify(mesh, options);
    EXPECT_EQ(run.report.aggregate->parts, 8U);
    EXPECT_EQ(run.report.aggregate->merged_cells, 0U);
    options.aggregate.reset();
    EXPECT_EQ(run.report.result_hash, run_simplify(mesh, options).report.result_hash);
}

TEST(Aggregate, OnePartIsNeverJoinedWithItself) {
    // The inner radius of the torus is .2; a sheet folded over would be as near.
    const Mesh mesh = torus(40, 20, 0.8);
    SimplifyOptions options = joining(800, 0.5);
    const Outcome run = run_simplify(mesh, options);
    EXPECT_EQ(run.report.lods[0].topology.euler, 0);
    options.aggregate.reset();
    EXPECT_EQ(run.report.result_hash, run_simplify(mesh, options).report.result_hash);
}

TEST(Aggregate, PercentIsOfTheDiagonal) {
    const Mesh mesh = crowd(3, 0.1, 3);
    SimplifyOptions options = joining(200, 0.2);
    const std::string expected = run_simplify(mesh, options).report.result_hash;
    options.aggregate = Target{Target::Kind::RelativeError, 0.2 / bounds_of(mesh).diagonal()};
    EXPECT_EQ(run_simplify(mesh, options).report.result_hash, expected);
}

TEST(Aggregate, ThreadsMemoryAndOrderDoNotShow) {
    const Mesh mesh = with_colors(crowd(5, 0.1, 5));
    const auto run_with = [&](unsigned n_threads, std::uint64_t memory, bool spills) {
        SimplifyOptions options = joining(400, 0.2);
        options.n_threads = n_threads;
        options.memory_bytes = memory;
        options.tuning.spills_at_once = spills;
        options.tuning.sort_bytes = spills ? 4096 : 0;
        return run_simplify(mesh, options).report.result_hash;
    };
    const std::string expected = run_with(1, std::uint64_t{2} << 30, false);
    EXPECT_EQ(run_with(2, std::uint64_t{96} << 20, true), expected);
    EXPECT_EQ(run_with(5, std::uint64_t{96} << 20, true), expected);
}

TEST(Aggregate, ADistanceMustBeALength) {
    for (const Target& distance :
         {Target{Target::Kind::Triangles, 5}, Target{Target::Kind::Error, 0}}) {
        SimplifyOptions options = joining(100, 1);
        options.aggregate = distance;
        EXPECT_THROW(run_simplify(cube_sphere(8), options), InvalidArgument);
    }
}

}  // namespace hewer::test
