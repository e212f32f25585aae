// SPDX-License-Identifier: MIT
/// Arithmetic on Vec3. In the namespace of Vec3's users, so that no using-declaration is needed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "hewer/types.h"

namespace hewer {

/// Symmetric 3x3 matrix: xx, xy, xz, yy, yz, zz.
using Symmetric3 = std::array<double, 6>;

inline Vec3 operator*(const Symmetric3& m, const Vec3& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[1] * v[0] + m[3] * v[1] + m[4] * v[2],
            m[2] * v[0] + m[4] * v[1] + m[5] * v[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 operator*(double s, const Vec3& a) {
    return {s * a[0], s * a[1], s * a[2]};
}

/// Of the box, its walls included; never so for what is not a number.
inline bool is_inside(const Bounds& box, const Vec3& p) {
    return p[0] >= box.min[0] && p[1] >= box.min[1] && p[2] >= box.min[2] && p[0] <= box.max[0] &&
           p[1] <= box.max[1] && p[2] <= box.max[2];
}

/// From the box to a point; 0 inside.
inline double squared_distance(const Bounds& box, const Vec3& p) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double gap = std::max({box.min[k] - p[k], p[k] - box.max[k], 0.0});
        squared += gap * gap;
    }
    return squared;
}

}  // namespace hewer
