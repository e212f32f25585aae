// SPDX-License-Identifier: MIT
/// Which key ends a choice of the smallest, over more records than memory holds.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "ooc/array.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// The smallest key K for which the records with keys up to K weigh at least `weight`.
/// Precondition: all of them together do, weight > 0, and no key is negative (infinity may be).
///
/// Radix selection: keys that are not negative have the order of their bits, so each of four passes
/// over the records settles 16 bits. Memory: 512 KiB.
template <typename Record, typename Key, typename Weight>
double key_at_weight(ooc::Context& context, const ooc::Spool<Record>& records, std::uint64_t weight,
                     const Key& key, const Weight& weight_of) {
    constexpr unsigned kDigitBits = 16;
    constexpr std::uint64_t kRadix = 1U << kDigitBits;
    ooc::Array<std::uint64_t> weights(context.budget(), "histogram of keys", kRadix);
    std::uint64_t prefix = 0;
    for (unsigned settled = 0; settled < 64; settled += kDigitBits) {
        const unsigned shift = 64 - kDigitBits - settled;
        std::fill(weights.begin(), weights.end(), 0);
        ooc::SpoolReader<Record> reader(records);
        for (auto piece = reader.next_piece(); !piece.empty(); piece = reader.next_piece()) {
            for (const Record& record : piece) {
                const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(key(record)));
                if (settled > 0 && bits >> (shift + kDigitBits) != prefix) continue;
                weights[bits >> shift & (kRadix - 1)] += weight_of(record);
            }
        }
        context.check_stop();
        std::uint64_t digit = 0;
        while (weights[digit] < weight) weight -= weights[digit++];
        prefix = prefix << kDigitBits | digit;
    }
    return std::bit_cast<double>(prefix);
}

}  // namespace hewer::rsimp
