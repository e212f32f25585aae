// SPDX-License-Identifier: MIT
/// The point of a triangle that is nearest to another point.
#pragma once

#include <array>

#include "ooc/vec3.h"

namespace hewer {

struct TriangleFoot {
    std::array<double, 3> weights;  ///< barycentric
    bool is_inside;                 ///< not on an edge
};

/// The triangle may be degenerate.
TriangleFoot foot_of(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// From `p` to its foot.
inline double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const TriangleFoot foot = foot_of(p, a, b, c);
    const Vec3 way = p - (foot.weights[0] * a + foot.weights[1] * b + foot.weights[2] * c);
    return dot(way, way);
}

}  // namespace hewer
