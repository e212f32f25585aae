// SPDX-License-Identifier: MIT
#include "streaming/position_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "hewer/error.h"

namespace hewer::streaming {

namespace {

constexpr double kLargestFloat = std::numeric_limits<float>::max();
constexpr double kVisibleShare = 1e-5;  // of the diagonal: a hundredth of a pixel at 1000 pixels

double largest_magnitude(const Bounds& bounds) {
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        largest = std::max({largest, std::abs(bounds.min[i]), std::abs(bounds.max[i])});
    }
    return largest;
}

}  // namespace

bool float_is_too_coarse(const Bounds& bounds) {
    if (bounds.is_empty()) return false;
    const double largest = largest_magnitude(bounds);
    const double half_step = std::max(largest * 0x1p-24, 0x1p-150);
    return largest > kLargestFloat || half_step > kVisibleShare * bounds.diagonal();
}

bool needs_double(const SinkHeader& header) {
    return header.has_double_positions && float_is_too_coarse(header.bounds);
}

Vec3 local_origin(const Bounds& bounds) {
    Vec3 origin = bounds.center();
    const double diagonal = bounds.diagonal();
    if (!(diagonal > 0)) return origin;
    const int exponent = std::ilogb(diagonal);
    for (double& x : origin) x = std::ldexp(std::round(std::ldexp(x, -exponent)), exponent);
    return origin;
}

void require_float_range(const Bounds& bounds, const std::filesystem::path& path,
                         const char* format) {
    if (bounds.is_empty() || largest_magnitude(bounds) <= kLargestFloat) return;
    throw InvalidArgument(path.string() + ": " + format +
                          " holds coordinates up to 3.4e38 only; write .ply or .obj instead");
}

}  // namespace hewer::streaming
