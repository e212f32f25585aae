// SPDX-License-Identifier: MIT
/// Error targets hold for the measured distance, and exact shapes come out exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "hewer/measure.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

MeasureReport measured(const Mesh& original, const Mesh& simplified) {
    MeasureOptions options;
    options.n_samples = 20'000;
    options.n_threads = 2;
    const auto a = view_mesh(original);
    const auto b = view_mesh(simplified);
    return measure(*a, *b, options);
}

std::vector<std::pair<std::string, Mesh>> meshes() {
    return {{"sphere", cube_sphere(60)},
            {"noisy sphere", cube_sphere(60, 0.01)},
            {"torus", torus(240, 100)},
            {"plane", plane_grid(120, 0.003)},
            {"strip", moebius_strip(300, 30)},
            {"slab", scaled(cube_sphere(50), {1, 1, 0.05})}};
}

}  // namespace

TEST(ErrorBound, NoPointIsFartherThanAsked) {
    for (const auto& [name, mesh] : meshes()) {
        for (const double error : {0.01, 0.05}) {
            const Outcome run = run_simplify(mesh, options_for(Target::Kind::Error, error));
            const LodReport& lod = run.report.lods[0];
            EXPECT_LT(run.lods[0].triangles.size(), mesh.triangles.size()) << name;
            EXPECT_LE(lod.error_bound, error) << name;
            const MeasureReport distances = measured(mesh, run.lods[0]);
            EXPECT_LE(distances.backward.vertex_maximum, error) << name;
            if (lod.lost_cells == 0) {
                EXPECT_LE(distances.forward.maximum, error) << name;
            }
        }
    }
}

TEST(ErrorBound, RelativeErrorsAreSharesOfTheDiagonal) {
    for (const auto& [name, mesh] : meshes()) {
        const double error = 0.005 * bounds_of(mesh).diagonal();
        const Outcome relative =
            run_simplify(mesh, options_for(Target::Kind::RelativeError, 0.005));
        EXPECT_LE(relative.report.lods[0].error_bound, error) << name;
        const Outcome absolute = run_simplify(mesh, options_for(Target::Kind::Error, error));
        EXPECT_EQ(relative.report.result_hash, absolute.report.result_hash) << name;
    }
}

TEST(ErrorBound, TheReportedBoundHoldsForBudgetsToo) {
    for (const auto& [name, mesh] : meshes()) {
        const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 800));
        const MeasureReport distances = measured(mesh, run.lods[0]);
        const LodReport& lod = run.report.lods[0];
        EXPECT_LE(distances.backward.vertex_maximum, lod.error_bound) << name;
        if (lod.lost_cells == 0) {
            EXPECT_LE(distances.forward.vertex_maximum, lod.error_bound) << name;
        }
    }
}

TEST(ErrorBound, QualityOfASphereIsThatOfAGoodApproximation) {
    const Outcome run = run_simplify(cube_sphere(80), options_for(Target::Kind::Triangles, 1000));
    const MeasureReport distances = measured(cube_sphere(80), run.lods[0]);
    // A regular approximation by n triangles has a sagitta of about 4.8 / n of the radius.
    EXPECT_LT(distances.forward.rms, 4.8 / 1000);
    EXPECT_LT(distances.forward.maximum, 5 * 4.8 / 1000);
}

TEST(FlatAreas, ACubeKeepsItsCornersAndFaces) {
    const Mesh mesh = cube(71);  // 10 082 triangles a side
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 100));
    EXPECT_EQ(run.lods[0].triangles.size(), 100U);
    EXPECT_TRUE(count(run.lods[0]).is_closed());
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 c{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
        double nearest = 10;
        for (const Vec3& p : run.lods[0].positions) {
            nearest = std::min(nearest, std::hypot(p[0] - c[0], p[1] - c[1], p[2] - c[2]));
        }
        EXPECT_LT(nearest, 1e-3);
    }
    const MeasureReport distances = measured(mesh, run.lods[0]);
    EXPECT_LT(distances.forward.rms, 2e-4);
    EXPECT_LT(distances.backward.rms, 2e-4);
}

TEST(FlatAreas, DetailBesideAFlatAreaGetsTheTriangles) {
    // A bump in the middle of a flat sheet.
    Mesh mesh = plane_grid(150);
    for (Vec3& p : mesh.positions) {
        const double r2 = (p[0] - 0.5) * (p[0] - 0.5) + (p[1] - 0.5) * (p[1] - 0.5);
        p[2] = r2 < 0.01 ? 0.1 * (1 - r2 / 0.01) : 0;
    }
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 400));
    std::uint64_t on_bump = 0;
    for (const Vec3& p : run.lods[0].positions) {
        if (std::hypot(p[0] - 0.5, p[1] - 0.5) < 0.11) ++on_bump;
    }
    EXPECT_GT(2 * on_bump, run.lods[0].positions.size());  // on 4 % of the area
}

}  // namespace hewer::test
