// SPDX-License-Identifier: MIT
/// Numbers that are near each other, sent far apart (the finaliser of MurmurHash3).
#pragma once

#include <cstdint>

namespace hewer::cluster {

/// Good enough for the low bits of a table's place.
constexpr std::uint64_t scattered(std::uint64_t x) {
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdULL;
    return x ^ x >> 33;
}

/// All bits of the result depend on all of x.
constexpr std::uint64_t well_scattered(std::uint64_t x) {
    x = scattered(x) * 0xc4ceb9fe1a85ec53ULL;
    return x ^ x >> 33;
}

}  // namespace hewer::cluster
