// SPDX-License-Identifier: MIT
#include "rsimp/face_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ooc/vec3.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

/// By trying every side and corner, in double precision.
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto to_segment = [&](const Vec3& s, const Vec3& e) {
        const Vec3 d = e - s;
        const double n = dot(d, d);
        const double t = n > 0 ? std::clamp(dot(p - s, d) / n, 0.0, 1.0) : 0;
        const Vec3 r = p - (s + t * d);
        return dot(r, r);
    };
    double best = std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
    const Vec3 n = cross(b - a, c - a);
    const bool is_over = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                         dot(cross(a - c, p - c), n) >= 0;
    if (is_over && dot(n, n) > 0) {
        const double h = dot(p - a, n);
        best = std::min(best, h * h / dot(n, n));
    }
    return best;
}

struct Pieces {
    std::vector<Point3f> points;
    std::vector<LocalFace> faces;
};

Pieces pieces_of(const Mesh& mesh) {
    Pieces pieces;
    for (const Vec3& p : mesh.positions) {
        pieces.points.push_back(
            {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
    }
    for (const Triangle& t : mesh.triangles) {
        pieces.faces.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                                static_cast<std::uint32_t>(t[2])});
    }
    return pieces;
}

Vec3 to_double(const Point3f& p) {
    return {p[0], p[1], p[2]};
}

}  // namespace

TEST(FaceTree, FindsTheFaceThatAllComparisonsFind) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<Mesh> meshes = {test::cube_sphere(9, 0.2, 1), test::random_soup(40, 300, 5),
                                      test::plane_grid(3), test::random_soup(3, 1, 2)};
    test::Random random(7);
    for (const Mesh& mesh : meshes) {
        const Pieces pieces = pieces_of(mesh);
        const FaceTree tree(pieces.points, pieces.faces);
        std::uint32_t guess = 0;
        for (int i = 0; i < 300; ++i) {
            const Vec3 p{random.between(-1.5, 1.5), random.between(-1.5, 1.5),
                         random.between(-1.5, 1.5)};
            const Point3f q{static_cast<float>(p[0]), static_cast<float>(p[1]),
                            static_cast<float>(p[2])};
            const FaceTree::Hit hit = tree.nearest(q, kInfinity, guess);
            ASSERT_LT(hit.face, pieces.faces.size());
            guess = hit.slot;
            double best = std::numeric_limits<double>::infinity();
            for (const LocalFace& f : pieces.faces) {
                best = std::min(best, squared_distance(to_double(q), to_double(pieces.points[f[0]]),
                                                       to_double(pieces.points[f[1]]),
                                                       to_double(pieces.points[f[2]])));
            }
            EXPECT_NEAR(std::sqrt(static_cast<double>(hit.squared_distance)), std::sqrt(best),
                        2e-4);
        }
    }
}

TEST(FaceTree, FindsForManyPointsWhatItFindsForEach) {
    const std::vector<Mesh> meshes = {test::cube_sphere(40, 0.02, 1), test::random_soup(40, 300, 5),
                                      test::random_soup(3, 1, 2)};
    test::Random random(8);
    for (const Mesh& mesh : meshes) {
        const Pieces pieces = pieces_of(mesh);
        const FaceTree tree(pieces.points, pieces.faces);
        // A walk near the surface, now and then a leap.
        std::vector<Point3f> points;
        Point3f p{};
        for (int i = 0; i < 5000; ++i) {
            const double step = random.below(50) == 0 ? 1.5 : 0.02;
            for (float& x : p) x += static_cast<float>(random.between(-step, step));
            for (float& x : p) x = std::clamp(x, -1.2F, 1.2F);
            points.push_back(p);
        }
        for (const float most : {0.01F, 100.0F}) {
            std::uint32_t guess = 0;
            std::vector<FaceTree::Hit> hits(points.size());
            tree.nearest(points, most, guess, hits);
            ASSERT_EQ(hits.size(), points.size());
            for (std::size_t i = 0; i < points.size(); ++i) {
                const FaceTree::Hit hit = tree.nearest(points[i], most, 0);
                ASSERT_EQ(hits[i].face, hit.face) << i;
                ASSERT_EQ(hits[i].squared_distance, hit.squared_distance) << i;
            }
        }
    }
}

TEST(FaceTree, FindsNothingBeyondTheLimit) {
    const Pieces pieces = pieces_of(test::cube_sphere(6));
    const FaceTree tree(pieces.points, pieces.faces);
    EXPECT_EQ(tree.nearest({3, 0, 0}, 1, 0).face, FaceTree::kNone);
    EXPECT_NE(tree.nearest({1.5F, 0, 0}, 1, 0).face, FaceTree::kNone);
}

TEST(FaceTree, FacesWithoutAreaCountAsTheirEdges) {
    const std::vector<Point3f> points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {5, 5, 5}};
    const std::vector<LocalFace> faces = {{0, 1, 2}, {3, 3, 3}};
    const FaceTree tree(points, faces);
    const FaceTree::Hit hit = tree.nearest({1.5F, 1, 0}, 100, 0);
    EXPECT_EQ(hit.face, 0U);
    EXPECT_NEAR(hit.squared_distance, 1, 1e-5);
    EXPECT_EQ(tree.nearest({5, 5, 4}, 100, 0).face, 1U);
}

}  // namespace hewer::rsimp
