// SPDX-License-Identifier: MIT
/// What vertices become for this room: encoders of streaming::Dereference, and Morton order.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

inline bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/// As they are, in model units.
struct ModelEncoder {
    using Point = Vec3;
    [[nodiscard]] static Vec3 encode(const Vec3& p) { return p; }
    [[nodiscard]] static bool is_absent(const Vec3& p) { return !is_finite(p); }
};

/// On a lattice.
struct LatticeEncoder {
    using Point = LatticePoint;
    [[nodiscard]] LatticePoint encode(const Vec3& p) const {
        return is_finite(p) ? lattice.from_model(p) : LatticePoint{kAbsent, kAbsent, kAbsent};
    }
    [[nodiscard]] static bool is_absent(const LatticePoint& p) { return p[0] == kAbsent; }

    static constexpr std::int32_t kAbsent = std::numeric_limits<std::int32_t>::min();
    Lattice lattice;
};

/// Morton order without keys: the axis whose coordinates differ in the highest bit decides (Chan
/// 2002). A total order; equal points become neighbours.
struct MortonLess {
    bool operator()(const LatticePoint& p, const LatticePoint& q) const {
        std::size_t axis = 0;
        std::uint32_t most = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto x = static_cast<std::uint32_t>(p[i]) ^ static_cast<std::uint32_t>(q[i]);
            if (most < x && most < (most ^ x)) {
                axis = i;
                most = x;
            }
        }
        return p[axis] < q[axis];
    }
};

}  // namespace hewer::measuring
