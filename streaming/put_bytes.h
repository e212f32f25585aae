// SPDX-License-Identifier: MIT
/// Numbers into a byte buffer.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace hewer::streaming {

/// Stores `value` at `out` and returns the byte after it.
template <typename T>
char* put_bytes(char* out, T value) {
    static_assert(std::is_arithmetic_v<T>);
    static_assert(std::endian::native == std::endian::little,
                  "the formats are little endian; swap bytes here for another machine");
    std::memcpy(out, &value, sizeof value);
    return out + sizeof value;
}

/// 65535 / 255 = 257: the inverse of the widening in hewer/types.h, so that 8-bit colours come back
/// as they were.
inline std::uint8_t to_8_bits(std::uint16_t v) {
    return static_cast<std::uint8_t>((v + 128U) / 257U);
}

}  // namespace hewer::streaming
