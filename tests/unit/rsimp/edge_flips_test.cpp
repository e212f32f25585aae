// SPDX-License-Identifier: MIT
#include "rsimp/edge_flips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "rsimp/nearest_faces.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

constexpr double kFarthest = 1;

/// All vertices are its own.
MeshPiece piece_of(const Mesh& mesh) {
    MeshPiece piece;
    piece.positions = mesh.positions;
    for (const Triangle& t : mesh.triangles) {
        piece.faces.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                               static_cast<std::uint32_t>(t[2])});
    }
    piece.n_own = static_cast<std::uint32_t>(mesh.positions.size());
    return piece;
}

std::vector<Triangle> triangles_of(const MeshPiece& piece) {
    std::vector<Triangle> triangles;
    for (const LocalFace& f : piece.faces) triangles.push_back({f[0], f[1], f[2]});
    return triangles;
}

WeightedPoint point_at(const Vec3& p, const Vec3& normal, float weight = 1) {
    return {to_single(p), weight, to_single(normal)};
}

/// Sum of the squared distances of the points to the piece as it is.
double squares(ooc::Workers& workers, const MeshPiece& piece,
               const std::vector<WeightedPoint>& points) {
    NearestFaces nearest(workers, piece);
    double sum = 0;
    const auto hits = nearest.find(points, kFarthest);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (hits[i].face == FaceTree::kNone) continue;
        sum +=
            static_cast<double>(points[i].weight) * static_cast<double>(hits[i].squared_distance);
    }
    return sum;
}

std::uint64_t flip(ooc::Workers& workers, MeshPiece& piece,
                   const std::vector<WeightedPoint>& points) {
    EdgeFlips flips(piece);
    NearestFaces nearest(workers, piece);
    const auto hits = nearest.find(points, kFarthest);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (hits[i].face == FaceTree::kNone) continue;
        (void)flips.take(points[i], hits[i].face, hits[i].squared_distance);
    }
    const std::vector<LocalFace> before = piece.faces;
    const auto changes = flips.flip(workers, piece);
    std::size_t n_changed = 0;
    for (std::size_t f = 0; f < before.size(); ++f) n_changed += before[f] != piece.faces[f];
    EXPECT_EQ(changes.size(), n_changed);
    return flips.n_flips();
}

/// A roof of four corners, two of them on the ridge; its diagonal joins the other two.
Mesh roof_across() {
    Mesh mesh;
    mesh.positions = {{0, -1, 0}, {1, 0, 0.3}, {0, 1, 0}, {-1, 0, 0.3}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

std::vector<WeightedPoint> ridge_points() {
    std::vector<WeightedPoint> points;
    for (int i = -8; i <= 8; ++i) points.push_back(point_at({0.1 * i, 0, 0.3}, {0, 0, 1}));
    return points;
}

/// Up to `n` points beside the faces.
std::vector<WeightedPoint> points_around(const Mesh& mesh, std::uint64_t n, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<WeightedPoint> points;
    for (std::uint64_t i = 0; i < n; ++i) {
        const Triangle& t = mesh.triangles[random.below(mesh.triangles.size())];
        double a = random.unit();
        double b = random.unit();
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        const Vec3& p = mesh.positions[t[0]];
        const Vec3 q = p + (a * (mesh.positions[t[1]] - p)) + (b * (mesh.positions[t[2]] - p));
        const Vec3 n_of = test::cross_of(mesh, t);
        const double length = std::sqrt(dot(n_of, n_of));
        if (!(length > 0)) continue;  // no normal
        points.push_back(point_at(q + (random.between(-0.1, 0.1) / length) * n_of,
                                  (1 / length) * n_of, static_cast<float>(random.unit())));
    }
    return points;
}

TEST(EdgeFlips, TurnAnEdgeAlongTheRidgeThatThePointsShow) {
    const auto context = test::make_context();
    MeshPiece piece = piece_of(roof_across());
    const std::vector<WeightedPoint> points = ridge_points();
    EXPECT_EQ(flip(context->workers(), piece, points), 1U);
    EXPECT_EQ(test::triangle_set(triangles_of(piece)), (std::set<Triangle>{{0, 1, 3}, {1, 2, 3}}));
    EXPECT_LT(squares(context->workers(), piece, points), 1e-9);
    EXPECT_EQ(flip(context->workers(), piece, points), 0U) << "it is as it should be";
}

TEST(EdgeFlips, LeaveAloneWhatIsNotAllThePiecesOwn) {
    const auto context = test::make_context();
    MeshPiece piece = piece_of(roof_across());
    piece.n_own = 3;
    EXPECT_EQ(flip(context->workers(), piece, ridge_points()), 0U);
}

TEST(EdgeFlips, PointsSeenFromBehindDoNotCount) {
    const auto context = test::make_context();
    MeshPiece piece = piece_of(roof_across());
    std::vector<WeightedPoint> points = ridge_points();
    for (WeightedPoint& point : points) point.normal = {0, 0, -1};
    EXPECT_EQ(flip(context->workers(), piece, points), 0U);
}

TEST(EdgeFlips, NeverJoinNeighboursTwice) {
    // In a tetrahedron all corners are neighbours.
    const auto context = test::make_context();
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    MeshPiece piece = piece_of(mesh);
    EXPECT_EQ(flip(context->workers(), piece, points_around(mesh, 200, 3)), 0U);
}

TEST(EdgeFlips, KeepTopologyAndBringThePointsNearer) {
    const auto context = test::make_context();
    std::vector<Mesh> meshes{test::cube_sphere(6, 0.1, 2),
                             test::torus(20, 9),
                             test::plane_grid(12, 0.05, 4),
                             test::book(3, 6),
                             test::moebius_strip(30, 4),
                             test::with_turned_triangles(test::cube_sphere(5, 0.05), 0.3, 7),
                             test::random_soup(30, 80, 9)};
    std::uint64_t n_flips = 0;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            MeshPiece piece = piece_of(meshes[m]);
            const auto points = points_around(meshes[m], 15 * meshes[m].triangles.size(), seed);
            const test::Counts before = test::count(meshes[m]);
            const double squares_before = squares(context->workers(), piece, points);
            n_flips += flip(context->workers(), piece, points);
            const test::Counts after = test::count(triangles_of(piece), piece.positions.size());
            EXPECT_EQ(after.edges, before.edges) << m;
            EXPECT_EQ(after.border_edges, before.border_edges) << m;
            EXPECT_EQ(after.nonmanifold_edges, before.nonmanifold_edges) << m;
            EXPECT_EQ(after.unlike_edges, before.unlike_edges) << m;
            EXPECT_EQ(after.split_fans, before.split_fans) << m;
            EXPECT_EQ(after.euler, before.euler) << m;
            EXPECT_EQ(after.degenerate, before.degenerate) << m;
            EXPECT_LE(after.duplicates, before.duplicates) << m;
            // Points that see a face from behind are not counted by the flips.
            if (m < 3) {
                EXPECT_LE(squares(context->workers(), piece, points), squares_before) << m;
            }
        }
    }
    EXPECT_GT(n_flips, 100U);
}

TEST(EdgeFlips, ThreadsDoNotShow) {
    const Mesh mesh = test::cube_sphere(20, 0.05, 2);
    const auto points = points_around(mesh, 10 * mesh.triangles.size(), 1);
    std::vector<LocalFace> expected;
    for (const unsigned n_threads : {1U, 2U, 7U}) {
        ooc::Workers workers(n_threads);
        MeshPiece piece = piece_of(mesh);
        EXPECT_GT(flip(workers, piece, points), 0U);
        if (expected.empty()) expected = piece.faces;
        EXPECT_EQ(piece.faces, expected) << n_threads;
    }
}

}  // namespace

}  // namespace hewer::rsimp
