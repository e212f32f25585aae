// SPDX-License-Identifier: MIT
/// Colours and normals go along, and where the model lies in space does not matter.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "ooc/vec3.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

TEST(Attributes, ColoursStayWhereTheyWere) {
    const Mesh mesh = with_colors(cube_sphere(50, 0.01));
    for (const Method method : {Method::Refine, Method::Uniform, Method::Full}) {
        SimplifyOptions options = options_for(Target::Kind::Triangles, 1500);
        options.method = method;
        const Outcome run = run_simplify(mesh, options);
        ASSERT_EQ(run.lods[0].colors.size(), run.lods[0].positions.size());
        EXPECT_TRUE(run.report.input.has_colors);
        for (std::size_t v = 0; v < run.lods[0].positions.size(); ++v) {
            const Rgba16 expected = color_at(run.lods[0].positions[v]);
            for (std::size_t i = 0; i < 4; ++i) {
                // A cluster is about a tenth of the radius wide: 2000 steps of colour.
                EXPECT_LE(std::abs(run.lods[0].colors[v][i] - expected[i]), 3000) << i;
            }
        }
    }
}

TEST(Attributes, OneColourStaysThatColour) {
    Mesh mesh = torus(100, 40);
    const Rgba16 color{257, 65535, 12345, 40000};
    mesh.colors.assign(mesh.positions.size(), color);
    for (const double target : {2000.0, 100.0}) {
        const Outcome run = run_simplify(mesh, options_for(Target::Kind::Triangles, target));
        ASSERT_EQ(run.lods[0].colors.size(), run.lods[0].positions.size());
        for (const Rgba16& c : run.lods[0].colors) {
            for (std::size_t i = 0; i < 4; ++i) EXPECT_LE(std::abs(c[i] - color[i]), 1);
        }
    }
}

TEST(Attributes, NormalsAreUnitAndPointWhereTheSurfaceDoes) {
    const Outcome run = run_simplify(with_radial_normals(cube_sphere(50, 0.002)),
                                     options_for(Target::Kind::Triangles, 1500));
    ASSERT_EQ(run.lods[0].normals.size(), run.lods[0].positions.size());
    for (std::size_t v = 0; v < run.lods[0].positions.size(); ++v) {
        const auto& f = run.lods[0].normals[v];
        const Vec3 n{static_cast<double>(f[0]), static_cast<double>(f[1]),
                     static_cast<double>(f[2])};
        const Vec3& p = run.lods[0].positions[v];
        EXPECT_NEAR(dot(n, n), 1, 1e-5);
        EXPECT_GT(dot(n, p) / std::sqrt(dot(p, p)), 0.99);
    }
}

TEST(Attributes, AreAbsentWhereTheInputHasNone) {
    const Outcome run =
        run_simplify(cube_sphere(20), options_for(Target::Kind::Triangles, 500));
    EXPECT_TRUE(run.lods[0].normals.empty());
    EXPECT_TRUE(run.lods[0].colors.empty());
}

TEST(Placement, AModelFarFromTheOriginKeepsItsPrecision) {
    const Vec3 offset{5e5, 5e6, 100};
    const Mesh near = rounded(cube_sphere(50, 0.01));
    const Outcome a = run_simplify(near, options_for(Target::Kind::Triangles, 1500));
    const Outcome b =
        run_simplify(translated(near, offset), options_for(Target::Kind::Triangles, 1500));
    ASSERT_EQ(a.lods[0].triangles, b.lods[0].triangles);
    for (std::size_t v = 0; v < a.lods[0].positions.size(); ++v) {
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(a.lods[0].positions[v][i] + offset[i], b.lods[0].positions[v][i], 2e-6);
        }
    }
}

TEST(Placement, SizeDoesNotMatter) {
    const Mesh mesh = cube_sphere(40, 0.01);
    const Outcome a = run_simplify(mesh, options_for(Target::Kind::Triangles, 900));
    for (const double scale : {0x1p-60, 0x1p40}) {
        const Outcome b = run_simplify(scaled(mesh, {scale, scale, scale}),
                                       options_for(Target::Kind::Triangles, 900));
        EXPECT_EQ(a.lods[0].triangles, b.lods[0].triangles) << scale;
    }
}

TEST(Placement, AFlatModelIsNoSpecialCase) {
    const Outcome run = run_simplify(translated(plane_grid(50), {7, 8, 9}),
                                     options_for(Target::Kind::Triangles, 100));
    EXPECT_LE(run.lods[0].triangles.size(), 100U);
    EXPECT_GE(run.lods[0].triangles.size(), 99U);
    for (const Vec3& p : run.lods[0].positions) EXPECT_NEAR(p[2], 9, 1e-4);
}

}  // namespace hewer::test
