// SPDX-License-Identifier: MIT
/// A piece of a mesh with what lies around it, small enough to work on in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "hewer/types.h"
#include "rsimp/block_mesh.h"

namespace hewer::rsimp {

using Point3f = std::array<float, 3>;

inline Point3f to_single(const Vec3& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

inline Vec3 as_vec3(const Point3f& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// The first `n_own` vertices are its own; all of their faces are here, and all others within the
/// reach that was asked for.
struct MeshPiece {
    Vec3 centre{};                ///< of the piece, in the frame of the mesh
    std::vector<Vec3> positions;  ///< relative to the centre
    std::vector<LocalFace> faces;
    std::uint32_t n_own = 0;
};

/// A box in single precision; rounding is monotone, so that it still holds what went into it.
struct FloatBox {
    std::array<float, 3> low{kInfinity, kInfinity, kInfinity};
    std::array<float, 3> high{-kInfinity, -kInfinity, -kInfinity};

    void extend(const Vec3& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], static_cast<float>(p[k]));
            high[k] = std::max(high[k], static_cast<float>(p[k]));
        }
    }
    void extend(const FloatBox& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    [[nodiscard]] bool meets(const FloatBox& other, double reach) const {
        const auto r = static_cast<float>(reach);
        for (std::size_t k = 0; k < 3; ++k) {
            if (low[k] - r > other.high[k] || other.low[k] > high[k] + r) return false;
        }
        return true;
    }
    [[nodiscard]] Vec3 centre() const {
        Vec3 c;
        for (std::size_t k = 0; k < 3; ++k) {
            c[k] = 0.5 * (static_cast<double>(low[k]) + static_cast<double>(high[k]));
        }
        return c;
    }

  private:
    static constexpr float kInfinity = std::numeric_limits<float>::infinity();
};

}  // namespace hewer::rsimp
