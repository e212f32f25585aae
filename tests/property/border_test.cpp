// SPDX-License-Identifier: MIT
/// Borders deviate no more than the surface between them, and none appear.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "hewer/measure.h"
#include "ooc/vec3.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

using Segment = std::pair<Vec3, Vec3>;

/// A disc with waves, a wavy rim and a hole beside its middle.
Mesh wavy_plate(std::uint64_t n) {
    Mesh mesh = plane_grid(n);
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return std::all_of(t.begin(), t.end(), [&](std::uint64_t v) {
            const Vec3& p = mesh.positions[v];
            return std::hypot(p[0] - 0.6, p[1] - 0.55) < 0.18;
        });
    });
    std::vector<std::uint64_t> place(mesh.positions.size(), mesh.positions.size());
    Mesh result;
    for (Triangle t : mesh.triangles) {
        for (std::uint64_t& v : t) {
            if (place[v] == mesh.positions.size()) {
                place[v] = result.positions.size();
                result.positions.push_back(mesh.positions[v]);
            }
            v = place[v];
        }
        result.triangles.push_back(t);
    }
    for (Vec3& p : result.positions) {
        const double x = 2 * p[0] - 1;
        const double y = 2 * p[1] - 1;
        const double scale = 1 + 0.04 * std::sin(9 * std::atan2(y, x));
        p = {scale * x * std::sqrt(1 - y * y / 2), scale * y * std::sqrt(1 - x * x / 2),
             0.05 * std::sin(9 * x) * std::cos(7 * y)};
    }
    return result;
}

std::vector<Segment> border_of(const Mesh& mesh) {
    std::map<std::pair<std::uint64_t, std::uint64_t>, int> n_faces;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) ++n_faces[std::minmax(t[k], t[(k + 1) % 3])];
    }
    std::vector<Segment> border;
    for (const auto& [edge, n] : n_faces) {
        if (n == 1) border.emplace_back(mesh.positions[edge.first], mesh.positions[edge.second]);
    }
    return border;
}

double distance_sq(const Vec3& p, const Segment& s) {
    const Vec3 along = s.second - s.first;
    const double t = std::clamp(dot(p - s.first, along) / dot(along, along), 0.0, 1.0);
    const Vec3 off = p - (s.first + t * along);
    return dot(off, off);
}

/// Of points along one border from the other.
double rms(const std::vector<Segment>& from, const std::vector<Segment>& to) {
    double sum = 0;
    double all = 0;
    for (const Segment& s : from) {
        const Vec3 along = s.second - s.first;
        const double length = std::sqrt(dot(along, along));
        constexpr int kPoints = 8;
        for (int i = 0; i < kPoints; ++i) {
            const Vec3 p = s.first + ((i + 0.5) / kPoints) * along;
            double least = distance_sq(p, to.front());
            for (const Segment& other : to) least = std::min(least, distance_sq(p, other));
            sum += least * length;
            all += length;
        }
    }
    return std::sqrt(sum / all);
}

/// Rectangles of two triangles each, far apart: the roofs and walls of a city model.
Mesh rectangles(std::size_t n, std::uint64_t seed) {
    Random random(seed);
    const auto number = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.below(1'000'000)) * 1e-6;
    };
    const auto direction = [&] {
        for (;;) {
            const Vec3 d{number(-1, 1), number(-1, 1), number(-1, 1)};
            const double length = std::sqrt(dot(d, d));
            if (length > 0.1 && length < 1) return (1 / length) * d;
        }
    };
    Mesh mesh;
    for (std::size_t i = 0; i < n; ++i) {
        const std::array<std::size_t, 3> place{i % 8, i / 8 % 8, i / 64};
        Vec3 a{};
        for (std::size_t k = 0; k < 3; ++k) a[k] = 60 * static_cast<double>(place[k]);
        const Vec3 x = direction();
        Vec3 y = cross(x, direction());
        y = (number(5, 30) / std::sqrt(dot(y, y))) * y;
        const Vec3 b = a + number(5, 30) * x;
        Mesh one;
        one.positions = {a, b, b + y, a + y};
        one.triangles = {{0, 1, 2}, {0, 2, 3}};
        mesh = joined(std::move(mesh), one);
    }
    return mesh;
}

double border_rms(const Mesh& a, const Mesh& b) {
    return std::max(rms(border_of(a), border_of(b)), rms(border_of(b), border_of(a)));
}

double surface_rms(const Mesh& a, const Mesh& b) {
    const auto original = view_mesh(a);
    const auto lod = view_mesh(b);
    MeasureOptions options;
    options.n_samples = 20'000;
    const MeasureReport report = measure(*original, *lod, options);
    return std::max(report.forward.rms, report.backward.rms);
}

Mesh simplified(const Mesh& mesh, double triangles, Method method, unsigned fit_rounds = 4) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, triangles);
    options.method = method;
    options.fit_rounds = fit_rounds;
    return run_simplify(mesh, options).lods[0];
}

}  // namespace

TEST(Border, DeviatesNoMoreThanTheSurface) {
    const Mesh mesh = wavy_plate(80);
    for (const Method method : {Method::Full, Method::Refine}) {
        for (const double triangles : {2500.0, 600.0, 150.0}) {
            const Mesh lod = simplified(mesh, triangles, method);
            // With a fifth of the triangles the border has nearly as many vertices as it had, and
            // the surface is as close as that nowhere else.
            const double most = triangles > 2000 ? 1.4 : 1;
            EXPECT_LE(border_rms(mesh, lod), most * surface_rms(mesh, lod)) << triangles;
            EXPECT_EQ(count(lod).border_loops, 2U) << triangles;
        }
    }
}

TEST(Border, ComesCloserByTheFit) {
    const Mesh mesh = wavy_plate(120);
    const Mesh before = simplified(mesh, 150, Method::Full, 0);
    const Mesh after = simplified(mesh, 150, Method::Full, 4);
    EXPECT_LT(border_rms(mesh, after), 0.9 * border_rms(mesh, before));
}

TEST(Border, StaysOnAStraightOutline) {
    const Mesh mesh = plane_grid(80, 0.01);
    for (const double triangles : {3000.0, 700.0, 100.0}) {
        for (const auto& [a, b] : border_of(simplified(mesh, triangles, Method::Refine))) {
            for (const Vec3& p : {a, b}) {
                const double off = std::min(
                    {std::abs(p[0]), std::abs(1 - p[0]), std::abs(p[1]), std::abs(1 - p[1])});
                EXPECT_LT(off, 0.002) << triangles;
            }
        }
    }
}

TEST(Border, CornersOfRectanglesStayWithinThem) {
    // Where all of the surface were border, it would not count.
    const Mesh mesh = joined(rectangles(512, 5), scaled(cube_sphere(24), {90, 90, 90}));
    for (const double triangles : {4000.0, 1300.0}) {
        SimplifyOptions how = options_for(Target::Kind::Triangles, triangles);
        how.method = Method::Full;
        how.feedback_rounds = 0;
        how.fit_rounds = 0;
        const Mesh lod = run_simplify(mesh, how).lods[0];
        EXPECT_GE(static_cast<double>(lod.triangles.size()), 0.99 * triangles);
        const auto original = view_mesh(mesh);
        const auto view = view_mesh(lod);
        MeasureOptions options;
        options.n_samples = 20'000;
        const MeasureReport report = measure(*original, *view, options);
        // Two corners that met where their diagonals do would be up to 15 outside, half a side;
        // what a cell holds may be off by its length of 2.
        EXPECT_LT(report.backward.maximum, 2.5) << triangles;
    }
}

TEST(Border, StaysAsTheCollapseLeftItWhereWindingDisagrees) {
    const Mesh mesh = with_turned_triangles(plane_grid(60, 0.01), 0.5, 3);
    const auto plain = border_of(simplified(mesh, 700, Method::Refine, 0));
    const auto moved = border_of(simplified(mesh, 700, Method::Refine, 4));
    EXPECT_EQ(plain, moved);
}

TEST(Border, ClosedSurfacesGetNone) {
    for (const double triangles : {2000.0, 300.0, 30.0}) {
        EXPECT_TRUE(count(simplified(torus(100, 50), triangles, Method::Full)).is_closed());
    }
}

}  // namespace hewer::test
