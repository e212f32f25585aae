// SPDX-License-Identifier: MIT
/// Order statistics of more keys than memory holds.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "ooc/spool.h"

namespace hewer::rsimp {

/// The smallest key k such that the weights of all keys <= k add up to at least `wanted`; infinity
/// if all of them together do not. Keys must not be negative: then their bits are in the order of
/// the numbers, and four passes find the key, 16 bits at a time. Memory: 512 KiB.
///
/// @param key_of, weight_of  of a record.
template <typename Record, typename KeyOf, typename WeightOf>
double weighted_quantile(const ooc::Spool<Record>& records, std::uint64_t wanted,
                         const KeyOf& key_of, const WeightOf& weight_of) {
    constexpr unsigned kDigitBits = 16;
    constexpr std::uint64_t kRadix = 1U << kDigitBits;
    std::uint64_t prefix = 0;
    std::uint64_t below = 0;
    for (unsigned shift = 64; shift > 0;) {
        const unsigned above = shift;
        shift -= kDigitBits;
        std::vector<std::uint64_t> histogram(kRadix);
        ooc::SpoolReader<Record> reader(records);
        while (const Record* record = reader.next()) {
            const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(key_of(*record)));
            if (above < 64 && bits >> above != prefix) continue;
            histogram[bits >> shift & (kRadix - 1)] += weight_of(*record);
        }
        std::uint64_t digit = 0;
        while (digit < kRadix && below + histogram[digit] < wanted) below += histogram[digit++];
        if (digit == kRadix) return std::numeric_limits<double>::infinity();
        prefix = prefix << kDigitBits | digit;
    }
    return std::bit_cast<double>(prefix);
}

/// The n-th smallest, from 0. Precondition: n < keys.size().
inline double nth_smallest(const ooc::Spool<double>& keys, std::uint64_t n) {
    return weighted_quantile(
        keys, n + 1, [](double key) { return key; }, [](double) { return std::uint64_t{1}; });
}

}  // namespace hewer::rsimp
