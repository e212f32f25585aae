// SPDX-License-Identifier: MIT
/// The fit brings every LOD closer to the original and breaks nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "hewer/measure.h"
#include "ooc/vec3.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

Mesh fitted(const Mesh& mesh, double triangles, unsigned rounds, Method method = Method::Refine) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
    options.method = method;
    options.fit_rounds = rounds;
    return run_simplify(mesh, options).lods[0];
}

MeasureReport distance(const Mesh& original, const Mesh& simplified) {
    const auto a = view_mesh(original);
    const auto b = view_mesh(simplified);
    return measure(*a, *b);
}

/// A sphere with waves that the target cannot follow.
Mesh wavy_sphere() {
    return cube_sphere(60, 0.01, 3);
}

}  // namespace

TEST(Fit, BringsBothDirectionsCloserToTheOriginal) {
    const std::vector<std::pair<std::string, Mesh>> meshes = {{"wavy sphere", wavy_sphere()},
                                                              {"torus", torus(200, 100)},
                                                              {"plane", plane_grid(120, 0.01)}};
    for (const auto& [name, mesh] : meshes) {
        const MeasureReport before = distance(mesh, fitted(mesh, 900, 0));
        const MeasureReport after = distance(mesh, fitted(mesh, 900, 4));
        EXPECT_LT(after.forward.rms, 0.95 * before.forward.rms) << name;
        EXPECT_LT(after.backward.rms, 0.97 * before.backward.rms) << name;
    }
}

TEST(Fit, MoreRoundsComeCloser) {
    const Mesh mesh = wavy_sphere();
    double before = 1e9;
    for (const unsigned rounds : {0U, 1U, 4U}) {
        const double rms = distance(mesh, fitted(mesh, 700, rounds)).forward.rms;
        EXPECT_LT(rms, before) << rounds;
        before = rms;
    }
    // What pulls the vertices themselves keeps the end a little off the least RMS.
    EXPECT_LT(distance(mesh, fitted(mesh, 700, 16)).forward.rms, 1.02 * before);
}

TEST(Fit, SeesTheTrianglesOfAnInputThatIsNotMuchFiner) {
    // Seven vertices for each that is left: their places alone say too little of what lies between.
    const Mesh mesh = wavy_sphere();
    const double triangles = 0.14 * static_cast<double>(mesh.triangles.size());
    const double before = distance(mesh, fitted(mesh, triangles, 0, Method::Full)).forward.rms;
    const double after = distance(mesh, fitted(mesh, triangles, 4, Method::Full)).forward.rms;
    EXPECT_LT(after, 0.85 * before);
}

TEST(Fit, FlipsEdgesAndKeepsTheTopology) {
    for (const Mesh& mesh : {wavy_sphere(), torus(200, 100), plane_grid(100, 0.01)}) {
        const Counts plain = count(fitted(mesh, 500, 0));
        SimplifyOptions options = options_for(Target::Kind::Triangles, 500);
        options.method = Method::Refine;
        options.fit_rounds = 4;
        const Outcome run = run_simplify(mesh, options);
        EXPECT_GT(run.report.lods[0].fit.flips, 5U);
        const Counts moved = count(run.lods[0]);
        EXPECT_TRUE(moved.is_clean());
        EXPECT_EQ(moved.edges, plain.edges);
        EXPECT_EQ(moved.border_edges, plain.border_edges);
        EXPECT_EQ(moved.euler, plain.euler);
    }
}

TEST(Fit, FlipsNoEdgesWhereLevelsNestOrColoursCount) {
    const Mesh mesh = with_colors(wavy_sphere());
    SimplifyOptions options;
    for (const double n : {4000.0, 1000.0}) {
        options.targets.push_back({Target::Kind::Triangles, n});
    }
    const Outcome levels = run_simplify(mesh, options);
    EXPECT_GT(levels.report.lods[0].fit.flips, 0U);
    EXPECT_EQ(levels.report.lods[1].fit.flips, 0U);
    options.color_weight = 1;
    EXPECT_EQ(run_simplify(mesh, options).report.lods[0].fit.flips, 0U);
}

TEST(Fit, FoldsNoFace) {
    // A weight of colours keeps edges from flipping, so that faces can be compared one by one.
    const Mesh mesh = with_colors(cube_sphere(40, 0.03, 8));
    for (const double target : {60.0, 300.0, 3000.0}) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, target);
        options.method = Method::Refine;
        options.color_weight = 1e-9;
        options.fit_rounds = 0;
        const Outcome plain = run_simplify(mesh, options);
        options.fit_rounds = 12;
        const Outcome moved = run_simplify(mesh, options);
        ASSERT_EQ(triangle_set(plain.lods[0].triangles), triangle_set(moved.lods[0].triangles));
        std::uint64_t turned = 0;
        for (const Triangle& t : moved.lods[0].triangles) {
            if (dot(cross_of(plain.lods[0], t), cross_of(moved.lods[0], t)) <= 0) ++turned;
        }
        // Some were folded before, and are turned back in one of the two.
        EXPECT_LE(turned,
                  plain.report.lods[0].folded->unfolded + moved.report.lods[0].folded->unfolded)
            << target;
    }
}

TEST(Fit, LeavesNextToNoFaceFoldedWhereEdgesFlip) {
    // So smooth that it is a star around its middle: folded is what shows that its front.
    const Mesh mesh = cube_sphere(40, 0.004, 8);
    for (const double target : {60.0, 300.0, 3000.0}) {
        for (const unsigned rounds : {1U, 2U, 4U}) {
            const Mesh lod = fitted(mesh, target, rounds);
            const auto n_folded = std::count_if(
                lod.triangles.begin(), lod.triangles.end(),
                [&](const Triangle& t) { return dot(cross_of(lod, t), lod.positions[t[0]]) <= 0; });
            EXPECT_LE(static_cast<double>(n_folded), target / 1000) << target << ", " << rounds;
        }
    }
}

TEST(Fit, PartsThatVanishedDoNotPull) {
    // The small sphere has no triangle to spare: it goes, and what is near it must not reach for
    // it.
    const Mesh large = cube_sphere(40);
    const Mesh small = translated(scaled(cube_sphere(6), {0.02, 0.02, 0.02}), {1.3, 0, 0});
    const Mesh mesh = joined(large, small);
    SimplifyOptions options = options_for(Target::Kind::Triangles, 60);
    options.fit_rounds = 8;
    options.feedback_rounds = 0;
    const Mesh moved = run_simplify(mesh, options).lods[0];
    for (const Vec3& p : moved.positions) EXPECT_LT(p[0], 1.05);
}

TEST(Fit, DoesNotDependOnThreadsOrMemory) {
    const Mesh mesh = with_colors(wavy_sphere());
    SimplifyOptions options = options_for(Target::Kind::Triangles, 4000);
    options.fit_rounds = 3;
    options.n_threads = 1;
    const std::string hash = run_simplify(mesh, options).report.result_hash;
    for (const unsigned threads : {2U, 7U}) {
        options.n_threads = threads;
        for (const std::uint64_t page : {0ULL, 4096ULL}) {
            options.tuning.page_bytes = page;
            EXPECT_EQ(run_simplify(mesh, options).report.result_hash, hash);
        }
    }
}

TEST(Fit, EveryLodIsFittedAndTheyNest) {
    const Mesh mesh = wavy_sphere();
    SimplifyOptions options;
    for (const double n : {4000.0, 1000.0, 200.0}) {
        options.targets.push_back({Target::Kind::Triangles, n});
    }
    const Outcome run = run_simplify(mesh, options);
    for (const LodReport& lod : run.report.lods) {
        EXPECT_GT(lod.fit.rounds, 0U);
        EXPECT_GT(lod.fit.first_move, 0);
        EXPECT_LT(lod.fit.last_move, lod.fit.first_move);
        EXPECT_TRUE(lod.is_nested);
    }
}

TEST(Fit, IsOffUnderAnErrorBoundAndForUniform) {
    const Mesh mesh = wavy_sphere();
    EXPECT_EQ(run_simplify(mesh, options_for(Target::Kind::Error, 0.1)).report.lods[0].fit.rounds,
              0U);
    SimplifyOptions options = options_for(Target::Kind::Triangles, 2000);
    options.method = Method::Uniform;
    EXPECT_EQ(run_simplify(mesh, options).report.lods[0].fit.rounds, 0U);
    options.fit_rounds = 2;
    EXPECT_EQ(run_simplify(mesh, options).report.lods[0].fit.rounds, 2U);
    options = options_for(Target::Kind::Error, 0.1);
    options.fit_rounds = 2;
    EXPECT_THROW(run_simplify(mesh, options), InvalidArgument);
}

}  // namespace hewer::test
