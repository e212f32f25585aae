// SPDX-License-Identifier: MIT
/// Weights by vertex and by place: triangles go where they matter, within the same budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "hewer/error.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

constexpr double kTriangles = 1500;
/// A quarter of each way of the unit square, rough all over.
const Bounds corner_of_plate{{0, 0, -1}, {0.5, 0.5, 1}};

Mesh rough_plate() {
    return plane_grid(120, 0.004);
}

bool is_inside(const Bounds& box, const Vec3& p) {
    return p[0] >= box.min[0] && p[0] <= box.max[0] && p[1] >= box.min[1] && p[1] <= box.max[1];
}

/// Triangles whose first corner is in the box, of a mesh that has used its budget.
double count_in(const Mesh& mesh, const Bounds& box) {
    EXPECT_LE(mesh.triangles.size(), kTriangles);
    EXPECT_GE(mesh.triangles.size(), 0.99 * kTriangles);
    return static_cast<double>(
        std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                      [&](const Triangle& t) { return is_inside(box, mesh.positions[t[0]]); }));
}

SimplifyOptions plate_options(Method method) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, kTriangles);
    options.method = method;
    return options;
}

Mesh with_weights(Mesh mesh, const Bounds& box, float weight) {
    for (const Vec3& p : mesh.positions) mesh.weights.push_back(is_inside(box, p) ? weight : 1);
    return mesh;
}

}  // namespace

TEST(Focus, DrawsTrianglesIntoItsBox) {
    const Mesh mesh = rough_plate();
    for (const Method method : {Method::Refine, Method::Full}) {
        SimplifyOptions options = plate_options(method);
        const double before = count_in(run_simplify(mesh, options).lods[0], corner_of_plate);
        options.focus = {{corner_of_plate, 50}};
        EXPECT_GT(count_in(run_simplify(mesh, options).lods[0], corner_of_plate), 1.8 * before);
        options.focus = {{corner_of_plate, 0.02}};
        EXPECT_LT(count_in(run_simplify(mesh, options).lods[0], corner_of_plate), before / 1.8);
    }
}

TEST(Focus, MultipliesWhereBoxesOverlap) {
    const Mesh mesh = rough_plate();
    SimplifyOptions options = plate_options(Method::Refine);
    options.focus = {{corner_of_plate, 50}};
    const std::string expected = run_simplify(mesh, options).report.result_hash;
    options.focus = {{corner_of_plate, 5}, {corner_of_plate, 10}};
    EXPECT_EQ(run_simplify(mesh, options).report.result_hash, expected);
}

TEST(Focus, ThatMeetsNothingIsWarnedOf) {
    SimplifyOptions options = plate_options(Method::Refine);
    options.focus = {{{{5, 5, 5}, {6, 6, 6}}, 10}};
    const Outcome run = run_simplify(rough_plate(), options);
    ASSERT_EQ(run.report.warnings.size(), 1U);
    EXPECT_NE(run.report.warnings[0].find("no part of the surface"), std::string::npos);
}

TEST(VertexWeights, DrawTrianglesTheSameWay) {
    const Mesh mesh = rough_plate();
    for (const Method method : {Method::Refine, Method::Full}) {
        const SimplifyOptions options = plate_options(method);
        const double before = count_in(run_simplify(mesh, options).lods[0], corner_of_plate);
        const Outcome run = run_simplify(with_weights(mesh, corner_of_plate, 50), options);
        EXPECT_TRUE(run.report.input.has_weights);
        EXPECT_EQ(run.report.input.defects.bad_weights, 0U);
        EXPECT_GT(count_in(run.lods[0], corner_of_plate), 1.8 * before);
    }
}

TEST(VertexWeights, OfOneChangeNothing) {
    const Mesh mesh = rough_plate();
    const SimplifyOptions options = plate_options(Method::Refine);
    EXPECT_EQ(run_simplify(with_weights(mesh, corner_of_plate, 1), options).report.result_hash,
              run_simplify(mesh, options).report.result_hash);
}

TEST(VertexWeights, ThatAreNoWeightsAreCounted) {
    Mesh mesh = with_weights(rough_plate(), corner_of_plate, 1);
    const SimplifyOptions options = plate_options(Method::Refine);
    const std::string expected = run_simplify(mesh, options).report.result_hash;
    mesh.weights[5] = std::numeric_limits<float>::quiet_NaN();
    mesh.weights[77] = -3;
    const Outcome run = run_simplify(mesh, options);
    EXPECT_EQ(run.report.input.defects.bad_weights, 2U);
    EXPECT_EQ(run.report.result_hash, expected);  // they count as 1
    ASSERT_EQ(run.report.warnings.size(), 1U);

    mesh.weights.assign(mesh.positions.size(), 1000);
    const std::string most = run_simplify(mesh, options).report.result_hash;
    mesh.weights[9] = 5e7F;
    mesh.weights[10] = std::numeric_limits<float>::infinity();
    const Outcome clamped = run_simplify(mesh, options);
    EXPECT_EQ(clamped.report.input.defects.bad_weights, 2U);
    EXPECT_EQ(clamped.report.result_hash, most);

    SimplifyOptions strict = options;
    strict.strict = true;
    EXPECT_THROW(run_simplify(mesh, strict), FormatError);
}

TEST(VertexWeights, OfNoneLeaveAMesh) {
    Mesh mesh = cube_sphere(40, 0.01);
    mesh.weights.assign(mesh.positions.size(), 0);
    const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, 1000));
    EXPECT_GE(run.lods[0].triangles.size(), 990U);
    for (const Vec3& p : run.lods[0].positions) {
        EXPECT_NEAR(std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), 1, 0.1);
    }
}

TEST(Focus, OfBadRangeIsRefused) {
    SimplifyOptions options = plate_options(Method::Refine);
    options.focus = {{corner_of_plate, 1001}};
    EXPECT_THROW(run_simplify(rough_plate(), options), InvalidArgument);
    options.focus = {{corner_of_plate, -1}};
    EXPECT_THROW(run_simplify(rough_plate(), options), InvalidArgument);
    options.focus = {{Bounds{}, 1}};
    EXPECT_THROW(run_simplify(rough_plate(), options), InvalidArgument);
}

}  // namespace hewer::test
