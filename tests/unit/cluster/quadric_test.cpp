// SPDX-License-Identifier: MIT
#include "cluster/quadric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cluster/attribute_quadric.h"
#include "ooc/vec3.h"

#include "tests/support/shapes.h"

namespace hewer::cluster {

namespace {

Vec3 random_point(test::Random& random) {
    return {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
}

Quadric plane_quadric(Vec3 n, const Vec3& through, double weight) {
    n = (1 / std::sqrt(dot(n, n))) * n;
    const double d = -dot(n, through);
    Quadric q;
    q.a = {weight * n[0] * n[0], weight * n[0] * n[1], weight * n[0] * n[2],
           weight * n[1] * n[1], weight * n[1] * n[2], weight * n[2] * n[2]};
    q.b = (weight * d) * n;
    q.c = weight * d * d;
    return q;
}

void expect_decomposes(const Symmetric3& m, double scale) {
    const Eigen3 e = eigen_decomposition(m);
    EXPECT_GE(e.values[0], e.values[1]);
    EXPECT_GE(e.values[1], e.values[2]);
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 difference = m * e.vectors[i] - e.values[i] * e.vectors[i];
        EXPECT_LE(std::sqrt(dot(difference, difference)), 1e-13 * scale);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(dot(e.vectors[i], e.vectors[k]), i == k ? 1 : 0, 1e-13);
        }
    }
}

}  // namespace

TEST(EigenDecomposition, HoldsForRandomAndSpecialMatrices) {
    test::Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const double scale = std::pow(10, random.between(-12, 12));
        Symmetric3 m;
        for (double& x : m) x = scale * random.between(-1, 1);
        expect_decomposes(m, 10 * scale);
    }
    expect_decomposes({0, 0, 0, 0, 0, 0}, 1);
    expect_decomposes({2, 0, 0, 2, 0, 2}, 1);
    expect_decomposes({1, 0, 0, 5, 0, 3}, 10);
    expect_decomposes({1, 1, 1, 1, 1, 1}, 10);
}

TEST(Quadric, IsTheSumOfSquaredDistances) {
    test::Random random(2);
    for (int i = 0; i < 200; ++i) {
        const Vec3 n = random_point(random);
        const Vec3 p = random_point(random);
        const Vec3 x = random_point(random);
        const Quadric q = plane_quadric(n, p, 2.5);
        const double distance = dot(n, x - p) / std::sqrt(dot(n, n));
        EXPECT_NEAR(q.error(x), 2.5 * distance * distance, 1e-12);
        EXPECT_NEAR(q.trace(), 2.5, 1e-12);
        const Vec3 origin = random_point(random);
        EXPECT_NEAR(q.relative_to(origin).error(x - origin), q.error(x), 1e-12);
    }
}

TEST(MinimumFrom, NoPointNearbyIsBetterWhereAllDirectionsAreDetermined) {
    test::Random random(3);
    for (int i = 0; i < 300; ++i) {
        Quadric q;
        for (int k = 0; k < 5; ++k) {
            q += plane_quadric(random_point(random), random_point(random), random.between(0.5, 1));
        }
        const Eigen3 eigen = eigen_decomposition(q.a);
        if (eigen.values[2] < 2 * kSingular * eigen.values[0]) continue;
        const Vec3 x = minimum_from(q, eigen, random_point(random));
        const double least = q.error(x);
        for (const double step : {1e-3, 0.1, 3.0}) {
            for (int k = 0; k < 20; ++k) {
                EXPECT_GE(q.error(x + step * random_point(random)), least - 1e-12);
            }
        }
    }
}

TEST(MinimumFrom, StaysAtTheMeanWhereNothingIsSaid) {
    const Vec3 mean{0.3, -0.2, 0.4};
    const Quadric plane = plane_quadric({0, 0, 1}, {0, 0, 0.1}, 3);
    const Vec3 on_plane = minimum_from(plane, eigen_decomposition(plane.a), mean);
    EXPECT_NEAR(on_plane[0], 0.3, 1e-12);
    EXPECT_NEAR(on_plane[1], -0.2, 1e-12);
    EXPECT_NEAR(on_plane[2], 0.1, 1e-12);

    Quadric edge = plane;
    edge += plane_quadric({1, 0, 0}, {-0.4, 0, 0}, 1);
    const Vec3 on_edge = minimum_from(edge, eigen_decomposition(edge.a), mean);
    EXPECT_NEAR(on_edge[0], -0.4, 1e-12);
    EXPECT_NEAR(on_edge[1], -0.2, 1e-12);
    EXPECT_NEAR(on_edge[2], 0.1, 1e-12);

    const Quadric nothing;
    EXPECT_EQ(minimum_from(nothing, eigen_decomposition(nothing.a), mean), mean);
}

TEST(AttributeQuadric, LeavesWhatTheBestValuesLeave) {
    test::Random random(5);
    struct Piece {
        double weight;
        std::array<Vec3, kFittedAttributes> slopes;
        std::array<double, kFittedAttributes> levels;
    };
    std::vector<Piece> pieces(4);
    AttributeQuadric q;
    for (Piece& piece : pieces) {
        piece.weight = random.between(0.1, 2);
        for (Vec3& g : piece.slopes) g = random_point(random);
        for (double& d : piece.levels) d = random.between(-1, 1);
        q.add_piece(piece.weight, piece.slopes, piece.levels);
    }
    const Vec3 origin = random_point(random);
    const AttributeQuadric moved = q.relative_to(origin);
    for (int i = 0; i < 20; ++i) {
        const Vec3 x = random_point(random);
        double expected = 0;
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            double sum = 0;
            double weight = 0;
            for (const Piece& p : pieces) {
                sum += p.weight * (dot(p.slopes[j], x) + p.levels[j]);
                weight += p.weight;
            }
            const double best = sum / weight;
            EXPECT_NEAR(q.value(j, x), best, 1e-12);
            EXPECT_NEAR(moved.value(j, x - origin), best, 1e-12);
            for (const Piece& p : pieces) {
                const double d = dot(p.slopes[j], x) + p.levels[j] - best;
                expected += p.weight * d * d;
            }
        }
        EXPECT_NEAR(q.reduced().error(x), expected, 1e-11);
        EXPECT_NEAR(moved.reduced().error(x - origin), expected, 1e-11);
        const AttributeQuadric single = CellAttributeQuadric(moved).at(origin);
        EXPECT_NEAR(single.reduced().error(x), expected, 1e-4);
    }
}

TEST(AttributeQuadric, OfOneLinearFieldIsNothing) {
    test::Random random(6);
    std::array<Vec3, kFittedAttributes> slopes;
    std::array<double, kFittedAttributes> levels;
    for (Vec3& g : slopes) g = random_point(random);
    for (double& d : levels) d = random.between(-1, 1);
    AttributeQuadric q;
    for (int i = 0; i < 5; ++i) q.add_piece(random.between(0.1, 2), slopes, levels);
    for (int i = 0; i < 20; ++i) EXPECT_NEAR(q.reduced().error(random_point(random)), 0, 1e-12);
}

}  // namespace hewer::cluster
