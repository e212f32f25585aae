// SPDX-License-Identifier: MIT
/// Numbers for people to read.
#pragma once

#include <cstdint>
#include <string>

#include "hewer/types.h"

namespace hewer::app {

/// Six significant digits: "0.000123457".
std::string format_length(double value);
/// "12.3 s", "4 min 05 s", "2 h 03 min".
std::string format_seconds(double seconds);
/// `value` as a share of `whole`: "0.0123 %"; "-" if there is no whole.
std::string format_percent(double value, double whole);
/// "0 0 0 to 1 2 3".
std::string format_bounds(const Bounds& bounds);

/// "1 triangle", "1,234 triangles".
std::string format_plural(std::uint64_t count, const std::string& noun);

}  // namespace hewer::app
