// SPDX-License-Identifier: MIT
/// Nothing of a piece is lost when parts of it are taken away.
#include "measure/piece.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace hewer::measuring {
namespace {

Piece random_piece(std::mt19937& random, std::int32_t radius) {
    std::uniform_int_distribution<std::int32_t> coordinate(-radius, radius);
    Piece piece;
    for (LatticePoint& p : piece) {
        for (std::int32_t& x : p) x = coordinate(random);
    }
    return piece;
}

Vec3 random_point(std::mt19937& random, const Piece& piece) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double u = std::sqrt(unit(random));
    const double v = unit(random);
    Vec3 q{};
    for (std::size_t k = 0; k < 3; ++k) {
        q[k] = (1 - u) * piece[0][k] + u * (1 - v) * piece[1][k] + u * v * piece[2][k];
    }
    return q;
}

double area(const Piece& piece) {
    const Vec3 n = double_area_normal(piece);
    return std::sqrt(detail::dot(n, n)) / 2;
}

TEST(Piece, IsNoFartherThanItsFarthestCorner) {
    std::mt19937 random(1);
    for (int i = 0; i < 200; ++i) {
        const Piece piece = random_piece(random, 1 << 24);
        const LatticeTriangle t = random_piece(random, 1 << (10 + i % 15));
        const double bound = squared_distance(piece, t);
        for (int j = 0; j < 50; ++j) {
            EXPECT_LE(squared_distance(random_point(random, piece), t), bound * (1 + 1e-12));
        }
        EXPECT_GE(squared_distance(piece, t, bound / 2), bound / 2) << "a limit may cut it short";
    }
}

TEST(Piece, WhatIsNotLeftIsNear) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> share(0.05, 1.2);
    int n_cut = 0;
    for (int i = 0; i < 2000; ++i) {
        const Piece piece = random_piece(random, 1 << 24);
        LatticeTriangle t = random_piece(random, 1 << 24);
        if (i % 2 == 0) t[0] = piece[0];
        const double near = share(random) * squared_distance(piece, t);
        const Pieces rest = rest_of(piece, t, near);
        double left = 0;
        for (const Piece& part : rest) left += area(part);
        EXPECT_LE(left, area(piece) * (1 + 1e-3));
        if (left < 0.99 * area(piece)) ++n_cut;
        for (int j = 0; j < 20; ++j) {
            const Vec3 q = random_point(random, piece);
            const bool is_left = std::any_of(rest.begin(), rest.end(), [&](const Piece& part) {
                return squared_distance(q, part) <= 4;
            });
            EXPECT_TRUE(is_left || squared_distance(q, t) <= near * (1 + 1e-6));
        }
    }
    EXPECT_GT(n_cut, 500);
}

TEST(Piece, CuttingComesToAnEnd) {
    std::mt19937 random(3);
    for (int i = 0; i < 50; ++i) {
        Piece needle = random_piece(random, 1 << 28);
        needle[1] = needle[0];
        needle[1][static_cast<std::size_t>(i % 3)] += i % 5;
        const double hair = 1 << 20;
        std::vector<Piece> pending{needle};
        int n = 0;
        while (!pending.empty() && n < 100'000) {
            const Piece piece = pending.back();
            pending.pop_back();
            ++n;
            if (squared_radius(piece) <= hair * hair) continue;
            // A triangle that the first corner is near to, and the rest is not.
            const LatticeTriangle t{piece[0], piece[0], piece[0]};
            for (const Piece& part : rest_of(piece, t, 128.0 * 128)) pending.push_back(part);
        }
        EXPECT_LT(n, 100'000);
    }
}

}  // namespace
}  // namespace hewer::measuring
