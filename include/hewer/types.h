// SPDX-License-Identifier: MIT
/// Plain vocabulary shared by every door of the library: points, boxes, corner ids, colours.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace hewer {

/// A point or direction in model units.
using Vec3 = std::array<double, 3>;

/// Red, green, blue, alpha, each 0..65535. Wide enough for 8-bit, 16-bit and float sources:
/// an 8-bit value v is stored as v * 257, a float f as round(clamp(f, 0, 1) * 65535).
using Rgba16 = std::array<std::uint16_t, 4>;

/// Three vertex ids of a triangle, counter-clockwise seen from outside. 64-bit: no count is small.
using Triangle = std::array<std::uint64_t, 3>;

/// An axis-aligned box. Starts empty (min > max); grows by extend().
struct Bounds {
    Vec3 min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
    Vec3 max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool is_empty() const { return !(min[0] <= max[0]); }

    void extend(const Vec3& p) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (p[i] < min[i]) min[i] = p[i];
            if (p[i] > max[i]) max[i] = p[i];
        }
    }
    void extend(const Bounds& other) {
        if (other.is_empty()) return;
        extend(other.min);
        extend(other.max);
    }
    [[nodiscard]] Vec3 center() const {
        return {0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1]), 0.5 * (min[2] + max[2])};
    }
    /// Edge lengths; zero when empty.
    [[nodiscard]] Vec3 size() const {
        if (is_empty()) return {0, 0, 0};
        return {max[0] - min[0], max[1] - min[1], max[2] - min[2]};
    }
    [[nodiscard]] double diagonal() const {
        const Vec3 s = size();
        return std::sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
    }
};

}  // namespace hewer
