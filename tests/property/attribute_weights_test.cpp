// SPDX-License-Identifier: MIT
/// Colours and normals in the error metric: what is painted on a flat surface stays on it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "hewer/error.h"
#include "ooc/vec3.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

using Values = std::array<double, 3>;

constexpr std::uint64_t kSquares = 100;  // of the plates here, each way
constexpr double kTriangles = 600;

/// Squares of a fifth, black and white.
bool is_white(const Vec3& p) {
    return (static_cast<int>(5 * p[0]) + static_cast<int>(5 * p[1])) % 2 == 0;
}

Mesh painted_plate() {
    Mesh mesh = plane_grid(kSquares);
    for (const Vec3& p : mesh.positions) {
        mesh.colors.push_back(is_white(p) ? Rgba16{65535, 65535, 65535, 65535}
                                          : Rgba16{0, 0, 0, 65535});
    }
    return mesh;
}

/// The same pattern in the directions of the normals, 45 degrees apart.
Mesh plate_with_normals() {
    Mesh mesh = plane_grid(kSquares);
    constexpr float kSlope = 0.38268343F;  // sine of 22.5 degrees
    constexpr float kUp = 0.92387953F;
    for (const Vec3& p : mesh.positions) {
        mesh.normals.push_back({is_white(p) ? kSlope : -kSlope, 0, kUp});
    }
    return mesh;
}

Values color_of(const Mesh& mesh, std::uint64_t vertex) {
    const Rgba16& c = mesh.colors[vertex];
    return {c[0] / 65535.0, c[1] / 65535.0, c[2] / 65535.0};
}

Values normal_of(const Mesh& mesh, std::uint64_t vertex) {
    const auto& n = mesh.normals[vertex];
    return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

/// Of a flat mesh, interpolated in the triangle that (x, y) is in.
template <typename ValueOf>
Values value_at(const Mesh& mesh, double x, double y, const ValueOf& value_of) {
    for (const Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.positions[t[0]];
        const Vec3& b = mesh.positions[t[1]];
        const Vec3& c = mesh.positions[t[2]];
        const double det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if (det == 0) continue;
        const double v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / det;
        const double w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / det;
        constexpr double kRounding = -1e-6;
        if (v < kRounding || w < kRounding || v + w > 1 - kRounding) continue;
        Values sum{};
        const std::array<double, 3> weights{1 - v - w, v, w};
        for (std::size_t k = 0; k < 3; ++k) {
            const Values value = value_of(mesh, t[k]);
            for (std::size_t i = 0; i < 3; ++i) sum[i] += weights[k] * value[i];
        }
        return sum;
    }
    ADD_FAILURE() << "no triangle at " << x << ", " << y;
    return {};
}

/// Root mean square over points spread over the plate, a little off its rim.
template <typename ValueOf>
double rms_difference(const Mesh& original, const Mesh& result, const ValueOf& value_of) {
    constexpr std::size_t kPoints = 60;
    double sum = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
        for (std::size_t j = 0; j < kPoints; ++j) {
            const double x = 0.01 + 0.98 * (static_cast<double>(i) + 0.37) / kPoints;
            const double y = 0.01 + 0.98 * (static_cast<double>(j) + 0.61) / kPoints;
            const Values a = value_at(original, x, y, value_of);
            const Values b = value_at(result, x, y, value_of);
            for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
        }
    }
    return std::sqrt(sum / (3 * kPoints * kPoints));
}

SimplifyOptions plate_options(Method method) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, kTriangles);
    options.method = method;
    return options;
}

void expect_full_budget(const Mesh& mesh) {
    EXPECT_LE(mesh.triangles.size(), kTriangles);
    EXPECT_GE(mesh.triangles.size(), 0.99 * kTriangles);
}

}  // namespace

TEST(ColorWeight, KeepsThePatternOfAFlatPlate) {
    const Mesh plate = painted_plate();
    for (const Method method : {Method::Refine, Method::Full}) {
        SimplifyOptions options = plate_options(method);
        const Mesh without = run_simplify(plate, options).lods[0];
        options.color_weight = 1;
        const Mesh with = run_simplify(plate, options).lods[0];
        expect_full_budget(with);
        const double before = rms_difference(plate, without, color_of);
        EXPECT_LT(rms_difference(plate, with, color_of), 0.5 * before) << before;
    }
}

TEST(NormalWeight, KeepsTheShadingOfAFlatPlate) {
    const Mesh plate = plate_with_normals();
    for (const Method method : {Method::Refine, Method::Full}) {
        SimplifyOptions options = plate_options(method);
        const Mesh without = run_simplify(plate, options).lods[0];
        options.normal_weight = 1;
        const Mesh with = run_simplify(plate, options).lods[0];
        expect_full_budget(with);
        const double before = rms_difference(plate, without, normal_of);
        EXPECT_LT(rms_difference(plate, with, normal_of), 0.5 * before) << before;
    }
}

TEST(ColorWeight, CostsNothingWhereColoursAreASmoothShade) {
    // Rough without paint on one side, flat under a linear shade on the other.
    Mesh mesh = plane_grid(kSquares, 0.003);
    for (Vec3& p : mesh.positions) {
        if (p[0] > 0.5) p[2] = 0;
        const auto shade = static_cast<std::uint16_t>(65535 * (p[0] > 0.5 ? 2 * p[0] - 1 : 0));
        mesh.colors.push_back({shade, shade, shade, 65535});
    }
    const auto n_flat = [&](double weight) {
        SimplifyOptions options = plate_options(Method::Full);
        options.color_weight = weight;
        const Mesh result = run_simplify(mesh, options).lods[0];
        std::size_t n = 0;
        for (const Triangle& t : result.triangles) {
            double x = 0;
            for (const std::uint64_t v : t) x += result.positions[v][0] / 3;
            if (x > 0.5) ++n;
        }
        return n;
    };
    EXPECT_LE(static_cast<double>(n_flat(1)), static_cast<double>(n_flat(0)) + 0.1 * kTriangles);
}

TEST(ColorWeight, DoesNothingWhereThereAreNoColours) {
    const Mesh mesh = cube_sphere(40, 0.01);
    SimplifyOptions options = options_for(Target::Kind::Triangles, 1000);
    const std::string expected = run_simplify(mesh, options).report.result_hash;
    options.color_weight = 1;
    options.normal_weight = 1;
    EXPECT_EQ(run_simplify(mesh, options).report.result_hash, expected);
}

TEST(ColorWeight, LevelsOfDetailKeepWhatIsPainted) {
    const Mesh plate = painted_plate();
    SimplifyOptions options;
    options.targets = {{Target::Kind::Triangles, 1500}, {Target::Kind::Triangles, kTriangles}};
    options.method = Method::Full;
    const Mesh without = run_simplify(plate, options).lods[1];
    options.color_weight = 1;
    const Mesh with = run_simplify(plate, options).lods[1];
    expect_full_budget(with);
    EXPECT_LT(rms_difference(plate, with, color_of),
              0.5 * rms_difference(plate, without, color_of));
}

TEST(ColorWeight, IsRefusedWhereItCannotCount) {
    const Mesh plate = painted_plate();
    SimplifyOptions options = plate_options(Method::Uniform);
    options.color_weight = 1;
    EXPECT_THROW(run_simplify(plate, options), InvalidArgument);
    options = plate_options(Method::Refine);
    options.color_weight = 1;
    options.priority = SplitPriority::NormalVariation;
    EXPECT_THROW(run_simplify(plate, options), InvalidArgument);
    options = plate_options(Method::Refine);
    options.normal_weight = -1;
    EXPECT_THROW(run_simplify(plate, options), InvalidArgument);
}

}  // namespace hewer::test
