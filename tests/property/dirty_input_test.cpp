// SPDX-License-Identifier: MIT
/// Dirt in the input is counted and survived, or refused with `strict`; contradictions are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Mesh with_nonfinite_vertices(Mesh mesh) {
    mesh.positions[10][1] = kNan;
    mesh.positions[500][0] = kInfinity;
    mesh.positions[700][2] = -kInfinity;
    return mesh;
}

/// One triangle with a repeated corner, one on a line, one of three coincident vertices.
Mesh with_degenerate_triangles(Mesh mesh) {
    const std::uint64_t n = mesh.positions.size();
    mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {0.25, 0, 0}, {0.5, 0, 0}});
    mesh.positions.insert(mesh.positions.end(), 3, Vec3{0, 0, 0.5});
    mesh.triangles.insert(mesh.triangles.begin() + 100,
                          {{5, 5, 9}, {n, n + 1, n + 2}, {n + 3, n + 4, n + 5}});
    return mesh;
}

Mesh with_bad_ids(Mesh mesh) {
    mesh.triangles.insert(mesh.triangles.begin() + 50,
                          {{0, 1, mesh.positions.size()}, {1ULL << 40, 2, 3}});
    return mesh;
}

SimplifyOptions strict_options() {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 500);
    options.strict = true;
    return options;
}

}  // namespace

TEST(DirtyInput, NonfiniteVerticesAreCountedAndLeftOut) {
    const Mesh mesh = with_nonfinite_vertices(cube_sphere(20, 0.02));
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 500));
    const InputDefects& defects = run.report.input.defects;
    const auto is_bad = [](std::uint64_t v) { return v == 10 || v == 500 || v == 700; };
    const auto n_bad = static_cast<std::uint64_t>(
        std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
            return is_bad(t[0]) || is_bad(t[1]) || is_bad(t[2]);
        }));
    EXPECT_EQ(defects.nonfinite_vertices, 3U);
    EXPECT_EQ(defects.nonfinite_triangles, n_bad);
    EXPECT_NE(defects.first_nonfinite.find("10"), std::string::npos);
    EXPECT_EQ(run.report.input.triangles, mesh.triangles.size() - n_bad);
    EXPECT_FALSE(run.report.warnings.empty());
    EXPECT_LE(run.lods[0].triangles.size(), 500U);
    EXPECT_GE(run.lods[0].triangles.size(), 495U);
    for (const Vec3& p : run.lods[0].positions) {
        for (const double x : p) EXPECT_LE(std::abs(x), 1.1);
    }
}

TEST(DirtyInput, DegenerateTrianglesAreCounted) {
    const Outcome run = run_simplify(with_degenerate_triangles(cube_sphere(20, 0.02)),
                                     options_for(Target::Kind::Triangles, 500));
    EXPECT_EQ(run.report.input.defects.degenerate_triangles, 3U);
    EXPECT_LE(run.lods[0].triangles.size(), 500U);
    EXPECT_TRUE(count(run.lods[0]).is_clean());
}

TEST(DirtyInput, IdsOutOfRangeAreCounted) {
    const Outcome run = run_simplify(with_bad_ids(cube_sphere(20, 0.02)),
                                     options_for(Target::Kind::Triangles, 500));
    EXPECT_EQ(run.report.input.defects.out_of_range_triangles, 2U);
    EXPECT_FALSE(run.report.warnings.empty());
    EXPECT_TRUE(count(run.lods[0]).is_closed());
}

TEST(DirtyInput, DuplicateTrianglesLeaveACleanMesh) {
    Mesh mesh = plane_grid(30, 0.01);
    const std::vector<Triangle> once = mesh.triangles;
    mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.begin() + 400);
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 300));
    EXPECT_LE(run.lods[0].triangles.size(), 300U);
    EXPECT_TRUE(count(run.lods[0]).is_clean());
    EXPECT_EQ(run.report.lods[0].topology.components, 1U);
}

TEST(DirtyInput, UnusedVerticesDoNotShow) {
    Mesh mesh = cube_sphere(20, 0.02);
    Random random(3);
    for (int i = 0; i < 5000; ++i) {
        mesh.positions.push_back({random.unit(), random.unit(), random.unit()});
    }
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 500));
    EXPECT_EQ(run.lods[0].triangles.size(), 500U);
    EXPECT_TRUE(count(run.lods[0]).is_closed());
}

TEST(DirtyInput, StrictRefusesEachDefect) {
    const Mesh good = cube_sphere(20, 0.02);
    EXPECT_NO_THROW(run_simplify(good, strict_options()));
    EXPECT_THROW(run_simplify(with_degenerate_triangles(good), strict_options()), FormatError);
    EXPECT_THROW(run_simplify(with_nonfinite_vertices(good), strict_options()), FormatError);
    EXPECT_THROW(run_simplify(with_bad_ids(good), strict_options()), FormatError);
}

TEST(DirtyInput, NothingUsableIsAFormatError) {
    const SimplifyOptions options = options_for(Target::Kind::Triangles, 100);
    EXPECT_THROW(run_simplify(Mesh{}, options), FormatError);
    Mesh mesh = cube_sphere(5);
    mesh.triangles.clear();
    EXPECT_THROW(run_simplify(mesh, options), FormatError);
    mesh.triangles = {{0, 1, 999'999}};
    EXPECT_THROW(run_simplify(mesh, options), FormatError);
    mesh = cube_sphere(5);
    for (Vec3& p : mesh.positions) p[0] = kNan;
    EXPECT_THROW(run_simplify(mesh, options), FormatError);
    mesh = cube_sphere(5);
    for (std::size_t i = 1; i < mesh.positions.size(); ++i) mesh.positions[i][2] = kInfinity;
    EXPECT_THROW(run_simplify(mesh, options), FormatError);
}

TEST(DirtyInput, ASurfaceThatIsAPointOrALineIsAnErrorNotACrash) {
    Mesh point = cube_sphere(5);
    for (Vec3& p : point.positions) p = {1, 2, 3};
    EXPECT_THROW(run_simplify(point, options_for(Target::Kind::Triangles, 100)), Error);
    Mesh line = cube_sphere(5);
    for (Vec3& p : line.positions) p = {p[0], 0, 0};
    try {
        const Outcome run = run_simplify(line, options_for(Target::Kind::Triangles, 100));
        EXPECT_LE(run.lods[0].triangles.size(), 100U);
    } catch (const Error& error) {
        EXPECT_STRNE(error.what(), "");
    }
}

TEST(DirtyInput, OneTriangleIsAModel) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 100));
    ASSERT_EQ(run.lods[0].triangles.size(), 1U);
    EXPECT_NEAR(area(run.lods[0]), 0.5, 1e-3);
}

TEST(GivenBounds, AVertexOutsideIsAFormatError) {
    const Mesh mesh = cube_sphere(20);
    SimplifyOptions options = options_for(Target::Kind::Triangles, 500);
    options.bounds = bounds_of(mesh);
    const Outcome given = run_simplify(mesh, options);
    EXPECT_EQ(given.report.result_hash,
              run_simplify(mesh, options_for(Target::Kind::Triangles, 500)).report.result_hash);
    options.bounds->max[1] = 0.9;
    EXPECT_THROW(run_simplify(mesh, options), FormatError);
}

TEST(GivenCell, IsTheCellOfTheGrid) {
    const Mesh mesh = cube_sphere(60);
    for (const double cell : {0.05, 0.173}) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 100);
        options.cell_size = cell;
        EXPECT_NEAR(run_simplify(mesh, options).report.grid.cell_size, cell, 1e-8);
        // Without a target the uniform method gives a vertex for each cell of the surface.
        options.targets.clear();
        options.method = Method::Uniform;
        const Outcome run = run_simplify(mesh, options);
        EXPECT_NEAR(run.report.grid.cell_size, cell, 1e-8);
        EXPECT_LE(run.report.lods[0].error_bound, 1.75 * cell);
        const auto n = static_cast<double>(run.lods[0].positions.size());
        EXPECT_NEAR(n, static_cast<double>(run.report.grid.occupied_cells), 0.02 * n);
    }
}

TEST(Options, ContradictionsAreRefusedBeforeAnyWork) {
    using Change = std::function<void(SimplifyOptions&)>;
    const auto triangles = [](double n) { return Target{Target::Kind::Triangles, n}; };
    const std::vector<std::pair<std::string, Change>> cases{
        {"no target", [](SimplifyOptions& o) { o.targets.clear(); }},
        {"zero", [](SimplifyOptions& o) { o.targets[0].value = 0; }},
        {"negative", [](SimplifyOptions& o) { o.targets[0].value = -3; }},
        {"not a number", [](SimplifyOptions& o) { o.targets[0].value = kNan; }},
        {"infinite", [](SimplifyOptions& o) { o.targets[0].value = kInfinity; }},
        {"ratio above one",
         [](SimplifyOptions& o) {
             o.targets = {{Target::Kind::Ratio, 1.5}};
         }},
        {"two kinds",
         [&](SimplifyOptions& o) {
             o.targets = {triangles(100), {Target::Kind::Vertices, 10}};
         }},
        {"coarse to fine",
         [&](SimplifyOptions& o) {
             o.targets = {triangles(10), triangles(100)};
         }},
        {"the same twice",
         [&](SimplifyOptions& o) {
             o.targets = {triangles(10), triangles(10)};
         }},
        {"errors fall",
         [](SimplifyOptions& o) {
             o.targets = {{Target::Kind::Error, 0.2}, {Target::Kind::Error, 0.1}};
         }},
        {"uniform with an error",
         [](SimplifyOptions& o) {
             o.method = Method::Uniform;
             o.targets = {{Target::Kind::Error, 0.1}};
         }},
        {"uniform with several",
         [&](SimplifyOptions& o) {
             o.method = Method::Uniform;
             o.targets = {triangles(100), triangles(10)};
         }},
        {"uniform with a cell and a target",
         [](SimplifyOptions& o) {
             o.method = Method::Uniform;
             o.cell_size = 0.1;
         }},
        {"full with a cell",
         [](SimplifyOptions& o) {
             o.method = Method::Full;
             o.cell_size = 0.1;
         }},
        {"cell of nothing", [](SimplifyOptions& o) { o.cell_size = 0; }},
        {"cell not a number", [](SimplifyOptions& o) { o.cell_size = kNan; }},
        {"cell too small", [](SimplifyOptions& o) { o.cell_size = 1e-7; }},
        {"error too small",
         [](SimplifyOptions& o) {
             o.targets = {{Target::Kind::Error, 1e-7}};
         }},
        {"negative border weight", [](SimplifyOptions& o) { o.border_weight = -1; }},
        {"border weight not a number", [](SimplifyOptions& o) { o.border_weight = kNan; }},
        {"empty bounds", [](SimplifyOptions& o) { o.bounds = Bounds{}; }},
    };
    const Mesh mesh = cube_sphere(5);
    for (const auto& [name, change] : cases) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 100);
        change(options);
        EXPECT_THROW(run_simplify(mesh, options), InvalidArgument) << name;
    }
}

}  // namespace hewer::test
