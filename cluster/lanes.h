// SPDX-License-Identifier: MIT
/// Arithmetic on four numbers at once, one in each lane of a vector that the compiler keeps in a
/// register or two, and rounding that fits into it. Results come by reference: a vector that is
/// returned would change the calling convention with the machine.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "ooc/vector_clones.h"

namespace hewer::cluster {

/// Nearest integer of x for |x| < 2^51, without a library call and in vector registers.
inline constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52
inline std::int64_t round_to_int(double x) {
    return std::bit_cast<std::int64_t>(x + kRounding) - std::bit_cast<std::int64_t>(kRounding);
}

using Reals = double __attribute__((vector_size(32)));
using Ints = std::int64_t __attribute__((vector_size(32)));
using Longs = std::uint64_t __attribute__((vector_size(32)));
using Words = std::uint32_t __attribute__((vector_size(16)));

template <typename Lanes>
using Lanes3 = std::array<Lanes, 3>;  ///< coordinates of four points or vectors

/// Rounded; see round_to_int().
HEWER_INLINE void round_to_ints(const Reals& x, Ints& result) {
    result =
        reinterpret_cast<Ints>(x + kRounding) - std::bit_cast<std::int64_t>(kRounding);  // NOLINT
}

HEWER_INLINE void square_root(const Reals& x, Reals& result) {
    result = Reals{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// yes where the lane of `mask` has all bits set, no where it has none.
template <typename Lanes, typename Mask>
HEWER_INLINE void choose(const Mask& mask, const Lanes& yes, const Lanes& no, Lanes& result) {
    static_assert(sizeof(Lanes) == sizeof(Mask));
    result = reinterpret_cast<Lanes>((mask & reinterpret_cast<Mask>(yes)) |
                                     (~mask & reinterpret_cast<Mask>(no)));
}

/// a x b in each lane.
template <typename Lanes>
HEWER_INLINE void cross_lanes(const Lanes3<Lanes>& a, const Lanes3<Lanes>& b,
                              Lanes3<Lanes>& result) {
    result = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Four vectors of four: lane j of vector i goes to lane i of vector j.
template <typename Lanes>
HEWER_INLINE void transpose(const std::array<Lanes, 4>& v, std::array<Lanes, 4>& result) {
    const Lanes even01 = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6);
    const Lanes odd01 = __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
    const Lanes even23 = __builtin_shufflevector(v[2], v[3], 0, 4, 2, 6);
    const Lanes odd23 = __builtin_shufflevector(v[2], v[3], 1, 5, 3, 7);
    result = {__builtin_shufflevector(even01, even23, 0, 1, 4, 5),
              __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5),
              __builtin_shufflevector(even01, even23, 2, 3, 6, 7),
              __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7)};
}

}  // namespace hewer::cluster
