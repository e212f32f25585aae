// SPDX-License-Identifier: MIT
/// Attribute quadrics: what it costs that a vertex stands where colours or normals do not fit.
/// Hoppe 1999, "New quadric metric for simplifying geometric meshes with appearance attributes".
#pragma once

#include <array>
#include <cstddef>

#include "cluster/quadric.h"
#include "ooc/vec3.h"

namespace hewer::cluster {

/// Red, green, blue; then x, y, z of the normal. Those that are not asked for are zero everywhere.
inline constexpr std::size_t kFittedAttributes = 6;

/// On a piece of the surface an attribute is linear, g.x + d. A vertex at x with the values s is
/// wrong there by the sum over the attributes of (g_j.x + d_j - s_j)^2, and over several pieces by
/// the sum of that, weighted with their areas. This holds what the sum needs; sums with the same
/// origin add. Attributes are scaled to lengths, so that the result adds to a Quadric's.
///
/// Unlike the paper's it keeps no s: at each x the best s_j is the weighted mean of g_j.x + d_j, so
/// what is left is a quadric in x alone (the Schur complement of the paper's matrix), and a vertex
/// is placed, moved and compared by one 3 x 3 matrix as it is without attributes.
struct AttributeQuadric {
    Quadric squares;                                ///< of all g_j.x + d_j
    double weight = 0;                              ///< area
    std::array<Vec3, kFittedAttributes> slope{};    ///< weighted sums of g_j
    std::array<double, kFittedAttributes> level{};  ///< weighted sums of d_j

    AttributeQuadric& operator+=(const AttributeQuadric& q) {
        squares += q.squares;
        weight += q.weight;
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            slope[j] = slope[j] + q.slope[j];
            level[j] += q.level[j];
        }
        return *this;
    }
    AttributeQuadric& operator*=(double factor) {
        for (double& x : squares.a) x *= factor;
        for (double& x : squares.b) x *= factor;
        squares.c *= factor;
        weight *= factor;
        for (Vec3& g : slope) g = factor * g;
        for (double& d : level) d *= factor;
        return *this;
    }

    /// A piece of the surface of area `w`, on which attribute j is slopes[j].x + levels[j].
    void add_piece(double w, const std::array<Vec3, kFittedAttributes>& slopes,
                   const std::array<double, kFittedAttributes>& levels) {
        weight += w;
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            const Vec3& g = slopes[j];
            const double d = levels[j];
            const Vec3 wg = w * g;
            squares.a[0] += wg[0] * g[0];
            squares.a[1] += wg[0] * g[1];
            squares.a[2] += wg[0] * g[2];
            squares.a[3] += wg[1] * g[1];
            squares.a[4] += wg[1] * g[2];
            squares.a[5] += wg[2] * g[2];
            squares.b = squares.b + d * wg;
            squares.c += w * d * d;
            slope[j] = slope[j] + wg;
            level[j] += w * d;
        }
    }

    /// The same for coordinates relative to `origin` (given in the present ones).
    [[nodiscard]] AttributeQuadric relative_to(const Vec3& origin) const {
        AttributeQuadric q = *this;
        q.squares = squares.relative_to(origin);
        for (std::size_t j = 0; j < kFittedAttributes; ++j) q.level[j] += dot(slope[j], origin);
        return q;
    }

    /// What is left at x with the best values there.
    [[nodiscard]] Quadric reduced() const {
        Quadric q = squares;
        if (!(weight > 0)) return q;
        const double r = -1 / weight;
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            const Vec3& g = slope[j];
            const Vec3 rg = r * g;
            q.a[0] += rg[0] * g[0];
            q.a[1] += rg[0] * g[1];
            q.a[2] += rg[0] * g[2];
            q.a[3] += rg[1] * g[1];
            q.a[4] += rg[1] * g[2];
            q.a[5] += rg[2] * g[2];
            q.b = q.b + level[j] * rg;
            q.c += r * level[j] * level[j];
        }
        return q;
    }

    /// The best value of attribute `j` at x. Precondition: weight > 0.
    [[nodiscard]] double value(std::size_t j, const Vec3& x) const {
        return (dot(slope[j], x) + level[j]) / weight;
    }
};

/// The same of one cell, relative to the cell's mean, in single precision.
struct CellAttributeQuadric {
    std::array<float, 10> squares;
    float weight;
    std::array<std::array<float, 3>, kFittedAttributes> slope;
    std::array<float, kFittedAttributes> level;

    explicit CellAttributeQuadric(const AttributeQuadric& q)
        : weight(static_cast<float>(q.weight)) {
        for (std::size_t i = 0; i < 6; ++i) squares[i] = static_cast<float>(q.squares.a[i]);
        for (std::size_t i = 0; i < 3; ++i) squares[6 + i] = static_cast<float>(q.squares.b[i]);
        squares[9] = static_cast<float>(q.squares.c);
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            for (std::size_t i = 0; i < 3; ++i) slope[j][i] = static_cast<float>(q.slope[j][i]);
            level[j] = static_cast<float>(q.level[j]);
        }
    }
    CellAttributeQuadric() = default;

    /// Relative to the origin from which the cell's mean is at `mean`.
    [[nodiscard]] AttributeQuadric at(const Vec3& mean) const {
        AttributeQuadric q;
        for (std::size_t i = 0; i < 6; ++i) q.squares.a[i] = static_cast<double>(squares[i]);
        for (std::size_t i = 0; i < 3; ++i) q.squares.b[i] = static_cast<double>(squares[6 + i]);
        q.squares.c = static_cast<double>(squares[9]);
        q.weight = static_cast<double>(weight);
        for (std::size_t j = 0; j < kFittedAttributes; ++j) {
            for (std::size_t i = 0; i < 3; ++i) q.slope[j][i] = static_cast<double>(slope[j][i]);
            q.level[j] = static_cast<double>(level[j]);
        }
        return q.relative_to({-mean[0], -mean[1], -mean[2]});
    }
};
static_assert(sizeof(CellAttributeQuadric) == 140);

}  // namespace hewer::cluster
