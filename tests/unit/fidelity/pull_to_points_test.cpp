// SPDX-License-Identifier: MIT
#include "fidelity/pull_to_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "ooc/vec3.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::fidelity {
namespace {

/// How high above its plane the grid is at (x, y): by the triangle that is there.
double height_at(const Mesh& mesh, double x, double y) {
    double highest = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.positions[t[0]];
        const Vec3& b = mesh.positions[t[1]];
        const Vec3& c = mesh.positions[t[2]];
        const double det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        const double v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / det;
        const double w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / det;
        if (v < -1e-9 || w < -1e-9 || v + w > 1 + 1e-9) continue;
        highest = std::max(highest, (1 - v - w) * a[2] + v * b[2] + w * c[2]);
    }
    return highest;
}

TEST(PullToPoints, PlaceInsideAFaceGetsAVertex) {
    Mesh mesh = test::plane_grid(4);
    const test::Counts before = test::count(mesh);
    const Vec3 to{0.25 / 3, 0.5 / 3, 0.05};  // above the middle of a face
    const std::vector<Pull> pulls{{to, to, 0}};
    const PullReport report = pull_to_points(mesh, pulls);
    EXPECT_EQ(report.n_done, 1U);
    EXPECT_EQ(report.vertices, 1U);
    EXPECT_EQ(report.triangles, 2U);
    EXPECT_EQ(report.border_edges, 0U);
    EXPECT_NEAR(height_at(mesh, to[0], to[1]), 0.05, 1e-12);
    const test::Counts after = test::count(mesh);
    EXPECT_TRUE(after.is_clean());
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_EQ(after.border_edges, before.border_edges);
}

TEST(PullToPoints, PlaceOnABorderSplitsItsEdge) {
    Mesh mesh = test::plane_grid(4);
    const std::uint64_t n = mesh.triangles.size();
    const std::uint64_t border = test::count(mesh).border_edges;
    const std::vector<Pull> pulls{{{0.125, 0, 0}, {0.125, -0.06, 0}, 0}};
    const PullReport report = pull_to_points(mesh, pulls);
    EXPECT_EQ(report.triangles, 1U);
    EXPECT_EQ(report.border_edges, 1U);
    EXPECT_EQ(mesh.triangles.size(), n + 1);
    const test::Counts after = test::count(mesh);
    EXPECT_TRUE(after.is_clean());
    EXPECT_EQ(after.border_edges, border + 1);
    EXPECT_LT(test::bounds_of(mesh).min[1], -0.05);
}

TEST(PullToPoints, PlaceThatIsNearlyNearEnoughMovesCornersAndTakesNoTriangle) {
    Mesh mesh = test::plane_grid(4);
    const Vec3 to{0.25 / 3, 0.5 / 3, 0.1};
    const std::vector<Pull> pulls{{to, to, 0.08}};
    const PullReport report = pull_to_points(mesh, pulls);
    EXPECT_EQ(report.n_done, 1U);
    EXPECT_EQ(report.triangles, 0U);
    EXPECT_NEAR(height_at(mesh, to[0], to[1]), 0.02, 1e-12);
}

TEST(PullToPoints, PlaceThatIsNearEnoughStaysAndOneThatIsToHaveAVertexGetsIt) {
    Mesh mesh = test::plane_grid(4);
    const Vec3 to{0.25 / 3, 0.5 / 3, 0.1};
    const std::vector<Pull> enough{{to, to, 0.11}};
    EXPECT_EQ(pull_to_points(mesh, enough).n_done, 0U);
    const std::vector<Pull> by_vertex{{to, to, 0.08, Pull::By::Vertex}};
    EXPECT_EQ(pull_to_points(mesh, by_vertex).vertices, 1U);
}

/// Two faces over a square whose edge bridges a hollow: the other diagonal is in it.
Mesh bridge() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0.2}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(PullToPoints, EdgeThatBridgesAHollowIsTurned) {
    Mesh mesh = bridge();
    const std::vector<Pull> pulls{{{0.5, 0.5, 0.2}, {0.5, 0.5, 0}, 0.01, Pull::By::Flip}};
    const PullReport report = pull_to_points(mesh, pulls);
    EXPECT_EQ(report.n_done, 1U);
    EXPECT_EQ(report.triangles, 0U);
    EXPECT_NEAR(height_at(mesh, 0.5, 0.5), 0, 1e-12);
    EXPECT_TRUE(test::count(mesh).is_clean());
    // Turned back it would be nearer to no point that is nearer than its other end.
    const std::vector<Pull> back{{{0.5, 0.5, 0}, {0.5, 0.5, 0.01}, 0.005, Pull::By::Flip}};
    EXPECT_EQ(pull_to_points(mesh, back).n_done, 1U);
    EXPECT_LT(height_at(mesh, 0.5, 0.5), 0.011);
}

TEST(PullToPoints, EdgeIsNotTurnedOntoOneThatIsThereAlready) {
    // A tetrahedron: both diagonals of any two of its faces are edges.
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.4, 0.4, 0.05}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    const std::vector<Pull> pulls{{{0.5, 0.5, 0}, {0.5, 0.5, 0.02}, 0.001, Pull::By::Flip}};
    pull_to_points(mesh, pulls);
    const test::Counts after = test::count(mesh);
    EXPECT_TRUE(after.is_clean());
    EXPECT_EQ(after.border_edges, 0U);
}

TEST(PullToPoints, CornersAloneMeansNoNewVertexHoweverFarThePlaceIs) {
    Mesh mesh = test::plane_grid(4);
    const Vec3 to{0.25 / 3, 0.5 / 3, 0.1};
    const std::vector<Pull> pulls{{to, to, 0.02, Pull::By::Corners}};
    const PullReport report = pull_to_points(mesh, pulls);
    EXPECT_EQ(report.n_done, 1U);
    EXPECT_EQ(report.vertices, 0U);
    EXPECT_NEAR(height_at(mesh, to[0], to[1]), 0.08, 1e-12);
}

TEST(PullToPoints, ReportNamesAllThatHasChangedAndWhereItWas) {
    test::Random random(5);
    for (int i = 0; i < 30; ++i) {
        Mesh mesh = test::cube_sphere(4, 0.05, static_cast<std::uint64_t>(i));
        const Mesh before = mesh;
        std::vector<Pull> pulls;
        for (int k = 0; k < 6; ++k) {
            const Vec3 at = mesh.positions[random.below(mesh.positions.size())];
            Vec3 to = at;
            for (double& x : to) x += random.between(-0.1, 0.1);
            pulls.push_back({at, to, 0.02, static_cast<Pull::By>(k % 4)});
        }
        const PullReport report = pull_to_points(mesh, pulls);
        EXPECT_EQ(report.boxes.size(), report.n_done);
        const auto is_in_a_box = [&](const Vec3& p) {
            return std::any_of(report.boxes.begin(), report.boxes.end(), [&](const Bounds& box) {
                return squared_distance(box, p) <= 1e-24;
            });
        };
        EXPECT_TRUE(std::is_sorted(report.faces.begin(), report.faces.end()));
        for (std::uint64_t f = 0; f < mesh.triangles.size(); ++f) {
            bool is_same = f < before.triangles.size() && mesh.triangles[f] == before.triangles[f];
            for (const std::uint64_t v : mesh.triangles[f]) {
                is_same = is_same && mesh.positions[v] == before.positions[v];
            }
            if (is_same) continue;
            EXPECT_TRUE(std::binary_search(report.faces.begin(), report.faces.end(), f));
            for (const std::uint64_t v : mesh.triangles[f]) {
                EXPECT_TRUE(is_in_a_box(mesh.positions[v]));
            }
            if (f >= before.triangles.size()) continue;
            for (const std::uint64_t v : before.triangles[f]) {
                EXPECT_TRUE(is_in_a_box(before.positions[v]));
            }
        }
    }
}

TEST(PullToPoints, NothingIsDoneThatTurnsAFaceOver) {
    Mesh mesh = test::plane_grid(4);
    const Mesh before = mesh;
    // Far beside the face that it begins at: any way there folds.
    const std::vector<Pull> pulls{{{0.6, 0.4, 0}, {0.1, 0.9, 0}, 0}};
    EXPECT_EQ(pull_to_points(mesh, pulls).n_done, 0U);
    EXPECT_EQ(mesh.positions, before.positions);
    EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(PullToPoints, OneOfTwoPullsAtAFaceIsLeftForTheNextRound) {
    Mesh mesh = test::plane_grid(4);
    const Vec3 first{0.25 / 3, 0.5 / 3, 0.05};
    const Vec3 second{0.3 / 3, 0.5 / 3, 0.01};
    const std::vector<Pull> pulls{{first, first, 0}, {second, second, 0}};
    EXPECT_EQ(pull_to_points(mesh, pulls).n_done, 1U);
    EXPECT_NEAR(height_at(mesh, first[0], first[1]), 0.05, 1e-12);
}

TEST(PullToPoints, NewVerticesHaveTheAttributesOfTheirPlace) {
    Mesh mesh = test::with_radial_normals(test::with_colors(test::cube_sphere(5)));
    Vec3 to{};
    const Triangle corners = mesh.triangles[7];
    for (const std::uint64_t v : corners) {
        for (std::size_t k = 0; k < 3; ++k) to[k] += mesh.positions[v][k] / 3;
    }
    for (double& x : to) x *= 1.05;
    const std::vector<Pull> pulls{{to, to, 0}};
    ASSERT_EQ(pull_to_points(mesh, pulls).vertices, 1U);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
    double length = 0;
    double along = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto n = static_cast<double>(mesh.normals.back()[k]);
        length += n * n;
        along += n * to[k];
    }
    EXPECT_NEAR(length, 1, 1e-6);
    EXPECT_GT(along, 0.99);
    const Rgba16 mean = mesh.colors.back();
    for (std::size_t k = 0; k < 3; ++k) {
        std::uint16_t low = 65535;
        std::uint16_t high = 0;
        for (const std::uint64_t v : corners) {
            low = std::min(low, mesh.colors[v][k]);
            high = std::max(high, mesh.colors[v][k]);
        }
        EXPECT_GE(mean[k] + 1, low);
        EXPECT_LE(mean[k], high + 1);
    }
}

TEST(PullToPoints, ClosedSurfaceStaysClosedWhateverPulls) {
    test::Random random(11);
    for (int trial = 0; trial < 20; ++trial) {
        Mesh mesh = test::cube_sphere(8, 0.1, static_cast<std::uint64_t>(trial));
        const std::uint64_t n_triangles = mesh.triangles.size();
        const std::uint64_t n_vertices = mesh.positions.size();
        std::vector<Pull> pulls(50);
        for (Pull& pull : pulls) {
            for (std::size_t k = 0; k < 3; ++k) {
                pull.from[k] = 2.4 * random.unit() - 1.2;
                pull.to[k] = pull.from[k] + 0.2 * (random.unit() - 0.5);
            }
            pull.near = 0.1 * random.unit();
        }
        const PullReport report = pull_to_points(mesh, pulls);
        EXPECT_GT(report.n_done, 0U);
        EXPECT_EQ(mesh.triangles.size(), n_triangles + report.triangles);
        EXPECT_EQ(mesh.positions.size(), n_vertices + report.vertices);
        const test::Counts counts = test::count(mesh);
        EXPECT_TRUE(counts.is_closed());
        EXPECT_TRUE(counts.is_clean());
        EXPECT_EQ(counts.euler, 2);
        EXPECT_EQ(counts.unlike_edges, 0U);
    }
}

TEST(PullToPoints, NothingToDoIsNothingDone) {
    Mesh empty;
    const std::vector<Pull> pulls{{{}, {}, 0}};
    EXPECT_EQ(pull_to_points(empty, pulls).n_done, 0U);
    Mesh mesh = test::cube(2);
    EXPECT_EQ(pull_to_points(mesh, {}).n_done, 0U);
}

}  // namespace
}  // namespace hewer::fidelity
