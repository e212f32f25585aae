// SPDX-License-Identifier: MIT
/// The coordinates that surface distances are computed in. (The room's namespace is `measuring`:
/// hewer::measure is the function.)
///
/// Both surfaces are put on one integer lattice, centred on their common box, whose step is a power
/// of two between 2^-31 and 2^-30 of the longest edge of that box. So a coordinate takes 4 bytes as
/// a float does, but:
/// - it is off by at most 5e-10 of the extent wherever it lies (a float: 3e-8), and an offset such
///   as that of UTM coordinates is gone, subtracted in double;
/// - a float coordinate of ordinary size is a multiple of the step and so kept exactly; equal
///   points of the two surfaces stay equal;
/// - differences fit 32 bits and cross products 64 bits: boxes and triangle normals are exact, and
///   a triangle is degenerate or it is not, without a tolerance.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hewer/types.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

/// Coordinates in steps, each within +-kLatticeRadius.
using LatticePoint = std::array<std::int32_t, 3>;
using LatticeTriangle = std::array<LatticePoint, 3>;

constexpr std::int32_t kLatticeRadius = (1 << 30) - 1;

class Lattice {
  public:
    Lattice() = default;
    /// `bounds` may be of no extent, but must not be empty.
    explicit Lattice(const Bounds& bounds) {
        const Vec3 size = bounds.size();
        const double extent = std::max({size[0], size[1], size[2]});
        // 2^(e-1) <= extent < 2^e. Half the extent is below 2^29 steps of 2^(e-30), and what
        // centring on the lattice adds is one step.
        int e = 0;
        std::frexp(extent, &e);
        constexpr int kSmallestExponent = -1000;  // keeps steps clear of denormal numbers
        step_ = extent > 0 ? std::ldexp(1.0, std::max(e - 30, kSmallestExponent)) : 1.0;
        const Vec3 center = bounds.center();
        for (std::size_t i = 0; i < 3; ++i) {
            origin_[i] = std::round(center[i] / step_) * step_;
        }
    }

    /// Model units a step.
    [[nodiscard]] double step() const { return step_; }

    [[nodiscard]] LatticePoint from_model(const Vec3& p) const {
        LatticePoint q{};
        for (std::size_t i = 0; i < 3; ++i) {
            const double x = std::nearbyint((p[i] - origin_[i]) / step_);
            q[i] =
                static_cast<std::int32_t>(std::clamp<double>(x, -kLatticeRadius, kLatticeRadius));
        }
        return q;
    }
    /// Of a box, in steps.
    [[nodiscard]] Bounds box_from_model(const Bounds& box) const {
        Bounds steps;
        for (const Vec3& p : {box.min, box.max}) {
            const LatticePoint q = from_model(p);
            steps.extend(Vec3{static_cast<double>(q[0]), static_cast<double>(q[1]),
                              static_cast<double>(q[2])});
        }
        return steps;
    }
    [[nodiscard]] Vec3 to_model(const Vec3& q) const {
        return {origin_[0] + q[0] * step_, origin_[1] + q[1] * step_, origin_[2] + q[2] * step_};
    }

  private:
    Vec3 origin_{};
    double step_ = 1;
};

/// As doubles, exactly.
HEWER_INLINE Vec3 to_double(const LatticePoint& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// Twice the area, along the normal: exact before the last rounding to double.
HEWER_INLINE Vec3 double_area_normal(const LatticeTriangle& t) {
    std::array<std::int64_t, 3> u{};
    std::array<std::int64_t, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) {
        u[i] = std::int64_t{t[1][i]} - t[0][i];
        v[i] = std::int64_t{t[2][i]} - t[0][i];
    }
    // |u|, |v| < 2^31: each product is below 2^62, each difference below 2^63.
    return {static_cast<double>(u[1] * v[2] - u[2] * v[1]),
            static_cast<double>(u[2] * v[0] - u[0] * v[2]),
            static_cast<double>(u[0] * v[1] - u[1] * v[0])};
}

}  // namespace hewer::measuring
