// SPDX-License-Identifier: MIT
/// Sorts records by an unsigned key, least significant digit first: stable, linear, no comparisons.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "ooc/array.h"

namespace hewer::ooc {

/// Sorts `records` by key(record), of up to 64 bits, using `scratch` of the same size; the result
/// is in `records`. Digits that are equal in all keys cost one counting pass for all of them
/// together.
template <typename Record, typename Key>
void radix_sort(Array<Record>& records, Array<Record>& scratch, const Key& key) {
    constexpr unsigned kDigitBits = 11;
    constexpr unsigned kDigits = 6;  // 66 bits
    constexpr std::uint64_t kRadix = 1U << kDigitBits;
    // A key of fewer bits must not be shifted by more than it has.
    const auto digit = [&](const Record& r, unsigned d) {
        return static_cast<std::uint64_t>(key(r)) >> (d * kDigitBits) & (kRadix - 1);
    };
    std::vector<std::uint64_t> counts(kDigits * kRadix);
    for (const Record& r : records) {
        for (unsigned d = 0; d < kDigits; ++d) ++counts[d * kRadix + digit(r, d)];
    }
    for (unsigned d = 0; d < kDigits; ++d) {
        std::uint64_t* count = &counts[d * kRadix];
        if (records.empty() || count[digit(records[0], d)] == records.size()) continue;
        std::uint64_t sum = 0;
        for (std::uint64_t i = 0; i < kRadix; ++i) sum += std::exchange(count[i], sum);
        for (const Record& r : records) scratch[count[digit(r, d)]++] = r;
        std::swap(records, scratch);
    }
}

}  // namespace hewer::ooc
