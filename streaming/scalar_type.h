// SPDX-License-Identifier: MIT
/// The scalar types of a PLY file, and loads of them in either byte order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "hewer/error.h"

namespace hewer::streaming {

enum class ScalarType : std::uint8_t {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64
};

constexpr std::uint32_t byte_size(ScalarType type) {
    constexpr std::array<std::uint8_t, 10> kSizes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(ScalarType type) {
    return type < ScalarType::Float32;
}

/// Names a C++ type to a generic lambda: `[](auto tag) { using T = typename decltype(tag)::Type;
/// }`.
template <typename T>
struct TypeTag {
    using Type = T;
};

/// Calls body(TypeTag<T>) for the C++ type of an integer `type`.
template <typename Body>
decltype(auto) with_integer_type(ScalarType type, const Body& body) {
    switch (type) {
        case ScalarType::Int8:
            return body(TypeTag<std::int8_t>{});
        case ScalarType::UInt8:
            return body(TypeTag<std::uint8_t>{});
        case ScalarType::Int16:
            return body(TypeTag<std::int16_t>{});
        case ScalarType::UInt16:
            return body(TypeTag<std::uint16_t>{});
        case ScalarType::Int32:
            return body(TypeTag<std::int32_t>{});
        case ScalarType::UInt32:
            return body(TypeTag<std::uint32_t>{});
        case ScalarType::Int64:
            return body(TypeTag<std::int64_t>{});
        case ScalarType::UInt64:
            return body(TypeTag<std::uint64_t>{});
        case ScalarType::Float32:
        case ScalarType::Float64:
            break;
    }
    throw InternalError("an integer type was expected");
}

/// Calls body(TypeTag<T>) for the C++ type of `type`.
template <typename Body>
decltype(auto) with_scalar_type(ScalarType type, const Body& body) {
    if (type == ScalarType::Float32) return body(TypeTag<float>{});
    if (type == ScalarType::Float64) return body(TypeTag<double>{});
    return with_integer_type(type, body);
}

/// The T at `p`, of any alignment; with `Swap`, its bytes in reverse order.
template <typename T, bool Swap>
T load(const unsigned char* p) {
    T value;
    if constexpr (!Swap || sizeof(T) == 1) {
        std::memcpy(&value, p, sizeof(T));
    } else if constexpr (sizeof(T) == 2) {
        std::uint16_t bits = 0;
        std::memcpy(&bits, p, 2);
        bits = __builtin_bswap16(bits);
        std::memcpy(&value, &bits, 2);
    } else if constexpr (sizeof(T) == 4) {
        std::uint32_t bits = 0;
        std::memcpy(&bits, p, 4);
        bits = __builtin_bswap32(bits);
        std::memcpy(&value, &bits, 4);
    } else {
        std::uint64_t bits = 0;
        std::memcpy(&bits, p, 8);
        bits = __builtin_bswap64(bits);
        std::memcpy(&value, &bits, 8);
    }
    return value;
}

/// An integer of the file as a 64-bit value: list counts and vertex ids. uint64 values from 2^63 on
/// come out negative, which no valid count or id is.
inline std::int64_t load_integer(ScalarType type, bool swap, const unsigned char* p) {
    return with_integer_type(type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        return static_cast<std::int64_t>(swap ? load<T, true>(p) : load<T, false>(p));
    });
}

/// Writes `value` at `out` as a `type` of this machine's byte order; what an integer type cannot
/// hold is clamped to its range, NaN becomes 0 there.
inline void store_scalar(ScalarType type, double value, unsigned char* out) {
    with_scalar_type(type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        T result{};
        if constexpr (std::is_floating_point_v<T>) {
            result = static_cast<T>(value);
        } else {
            constexpr double kLow = static_cast<double>(std::numeric_limits<T>::min());
            constexpr double kHigh = static_cast<double>(std::numeric_limits<T>::max());
            if (value >= kHigh) {
                result = std::numeric_limits<T>::max();
            } else if (value > kLow) {
                result = static_cast<T>(value);
            } else {
                result = value <= kLow ? std::numeric_limits<T>::min() : T{0};
            }
        }
        std::memcpy(out, &result, sizeof(T));
    });
}

}  // namespace hewer::streaming
