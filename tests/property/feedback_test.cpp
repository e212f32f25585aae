// SPDX-License-Identifier: MIT
/// What is thin or small is not spent for what is large.
#include <gtest/gtest.h>

#include <cmath>

#include "hewer/error.h"
#include "hewer/measure.h"
#include "ooc/vec3.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

/// A noisy sphere, and a blade that no quadric gives an area to.
Mesh sphere_with_blade() {
    return joined(cube_sphere(60, 0.01, 3),
                  translated(scaled(cube_sphere(20), {0.5, 0.5, 0.001}), {1.6, 0, 0}));
}

/// A sphere with twenty small ones around it.
Mesh sphere_with_moons() {
    Mesh mesh = cube_sphere(60, 0.005, 1);
    for (int i = 0; i < 20; ++i) {
        const double angle = 0.3 * i;
        const Mesh moon = scaled(cube_sphere(3), {0.01, 0.01, 0.01});
        mesh = joined(
            mesh, translated(moon, {1.5 * std::cos(angle), 1.5 * std::sin(angle), 0.05 * i - 0.5}));
    }
    return mesh;
}

Mesh octahedron() {
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                      {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

/// A sphere, and far from it octahedra so small that no budget in triangles would reach them by
/// their own size.
Mesh sphere_with_specks(int n) {
    Mesh mesh = cube_sphere(60, 0.005, 1);
    for (int i = 0; i < n; ++i) {
        const double angle = 0.3 * i;
        const Mesh speck = scaled(octahedron(), {0.02, 0.02, 0.02});
        mesh = joined(mesh,
                      translated(speck, {4 * std::cos(angle), 4 * std::sin(angle), 0.4 * i - 4}));
    }
    return mesh;
}

struct Result {
    SimplifyReport report;
    MeasureReport distance;
    Mesh mesh;
};

Result simplified(const Mesh& mesh, double triangles, unsigned rounds, unsigned n_threads = 2) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
    options.feedback_rounds = rounds;
    options.n_threads = n_threads;
    Outcome run = run_simplify(mesh, options);
    const auto a = view_mesh(mesh);
    const auto b = view_mesh(run.lods[0]);
    return {run.report, measure(*a, *b), std::move(run.lods[0])};
}

}  // namespace

TEST(Feedback, KeepsWhatIsThin) {
    const Mesh mesh = sphere_with_blade();
    const Result without = simplified(mesh, 400, 0);
    const Result with = simplified(mesh, 400, 2);
    EXPECT_LT(with.distance.forward.maximum, 0.6 * without.distance.forward.maximum);
    EXPECT_LT(with.distance.forward.rms, 1.02 * without.distance.forward.rms);
    EXPECT_EQ(with.report.feedback.rounds, 2U);
    EXPECT_LT(with.report.feedback.last_worst, with.report.feedback.first_worst);
    EXPECT_EQ(without.report.feedback.rounds, 0U);
}

TEST(Feedback, OfRefineIsMadeWhereMuchIsFarAndNotAskedFor) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 400);
    options.method = Method::Refine;
    EXPECT_EQ(run_simplify(sphere_with_blade(), options).report.feedback.rounds, 1U);
    EXPECT_EQ(run_simplify(cube_sphere(60, 0.01, 3), options).report.feedback.rounds, 0U);
    options.feedback_rounds = 0;
    EXPECT_EQ(run_simplify(sphere_with_blade(), options).report.feedback.rounds, 0U);
}

TEST(Feedback, ReachesTheTargetAllTheSame) {
    for (const double target : {100.0, 1000.0, 10000.0}) {
        const Result result = simplified(sphere_with_blade(), target, 3);
        EXPECT_LE(result.mesh.triangles.size(), target);
        EXPECT_GE(result.mesh.triangles.size(), 0.99 * target);
    }
}

TEST(Feedback, IsTheSameForAnyThreads) {
    const Mesh mesh = sphere_with_blade();
    EXPECT_EQ(simplified(mesh, 500, 2, 1).report.result_hash,
              simplified(mesh, 500, 2, 4).report.result_hash);
}

TEST(Feedback, ContradictsTheUniformMethod) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 100);
    options.method = Method::Uniform;
    options.feedback_rounds = 1;
    EXPECT_THROW(run_simplify(cube_sphere(5), options), InvalidArgument);
}

TEST(Feedback, KeepsSmallPartsWhereTheBudgetAllows) {
    const Result result = simplified(sphere_with_moons(), 1500, 2);
    EXPECT_EQ(result.report.lods[0].topology.components, 21U);
    EXPECT_EQ(result.report.lods[0].topology.border_edges, 0U);
}

// Their size alone is no reason to keep them, where they are is; and the four clusters that a part
// is first split into make no closed surface of an octahedron.
TEST(Feedback, KeepsSpecksThatAreFarFromAllElse) {
    const Mesh mesh = sphere_with_specks(20);
    const Result without = simplified(mesh, 1000, 0);
    const Result with = simplified(mesh, 1000, 2);
    EXPECT_LT(without.report.lods[0].topology.components, 21U);
    EXPECT_EQ(with.report.lods[0].topology.components, 21U);
    EXPECT_EQ(with.report.lods[0].topology.border_edges, 0U);
    EXPECT_LT(with.distance.forward.maximum, 0.1 * without.distance.forward.maximum);
}

}  // namespace hewer::test
