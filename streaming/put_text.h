// SPDX-License-Identifier: MIT
/// Numbers as text, for the writers of text formats.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hewer::streaming {

/// The longest number, "-2.2250738585072014e-308", and its separator.
constexpr std::size_t kNumberBytes = 25;
/// The longest id.
constexpr std::size_t kIdBytes = 20;

/// The shortest text that reads back as `x`, and " " before it. Fixed notation for the sizes that
/// meshes have, since not every reader knows exponents: at most 24 characters from 1e-5 to 1e16.
template <typename Float>
char* put_number(char* out, Float x) {
    const Float a = std::abs(x);
    const bool is_plain = a == 0 || (a >= Float(1e-5) && a < Float(1e16));
    *out++ = ' ';
    return std::to_chars(out, out + kNumberBytes, x,
                         is_plain ? std::chars_format::fixed : std::chars_format::scientific)
        .ptr;
}

inline char* put_id(char* out, std::uint64_t id) {
    return std::to_chars(out, out + kIdBytes, id).ptr;
}

}  // namespace hewer::streaming
