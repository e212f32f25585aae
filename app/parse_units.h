// SPDX-License-Identifier: MIT
/// The command line's way of writing numbers. Every function takes the whole text of a value and
/// throws InvalidArgument with a sentence that says what is wrong and what to write instead.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hewer/options.h"
#include "hewer/types.h"

namespace hewer::app {

/// "1500", "250k", "1.5M", "2G": decimal multiples; exact, so "1.0001k" is refused.
std::uint64_t parse_count(std::string_view text);

/// "512M", "1.5GiB", "65536": K, M, G, T with or without "iB" are powers of 1024; a bare number is
/// bytes. "MB" is refused because people disagree about it. Fractions of a byte are cut off.
std::uint64_t parse_bytes(std::string_view text);

/// "5%" or "0.05", both 0.05. A bare number of 1 or more is refused: "5" may mean 5 % or 5 times.
double parse_ratio(std::string_view text);

/// "0.5": model units; "0.01%": of the bounding box's diagonal.
Target parse_error(std::string_view text);

/// "1M,250k,60k" or "10%,2%,0.5%": at least two, all of one kind, from fine to coarse.
std::vector<Target> parse_lods(std::string_view text);

/// A finite number: "-1.5", "2e-3".
double parse_number(std::string_view text);

/// "x0,y0,z0,x1,y1,z1": the two opposite corners, not one point.
Bounds parse_box(std::string_view text);

/// "x0,y0,z0,x1,y1,z1:WEIGHT", the weight from 0 to 1000.
FocusBox parse_focus(std::string_view text);

/// "1920x1080".
std::array<std::uint64_t, 2> parse_pixels(std::string_view text);

/// "30,20".
std::array<double, 2> parse_pair(std::string_view text);

/// "auto", "14bit" (1 to 30), or a step above 0 in model units: "0.001".
Quantization parse_quantization(std::string_view text);

}  // namespace hewer::app
