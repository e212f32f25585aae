// SPDX-License-Identifier: MIT
/// Whether a point of the original and a face that is near it belong to the same sheet.
#pragma once

#include <cmath>

#include "ooc/vec3.h"

namespace hewer::rsimp {

/// Whether a face with this normal, of any length, shows its back to a point of a surface with the
/// unit normal `front`: they belong to different sheets. Noise turns normals far, but hardly over.
inline bool shows_back(const Vec3& normal, const Vec3& front) {
    constexpr double kLeastCosine = -0.2;
    return dot(normal, front) < kLeastCosine * std::sqrt(dot(normal, normal));
}

}  // namespace hewer::rsimp
