// SPDX-License-Identifier: MIT
/// Little-endian numbers into a byte buffer.
#pragma once

#include <bit>
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

}  // namespace hewer::streaming
