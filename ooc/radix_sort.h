// SPDX-License-Identifier: MIT
/// Sorts records by an unsigned key, least significant digit first: stable, linear, no comparisons.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "ooc/array.h"
#include "ooc/parallel.h"

namespace hewer::ooc {

/// Sorts `records` by key(record), of up to 64 bits, on all threads, using `scratch` of the same
/// size; the result is in `records`. Digits that are equal in all keys cost nothing but one pass
/// for all of them together. Memory: 16 KiB for each of four pieces a thread.
template <typename Record, typename Key>
void radix_sort(Workers& workers, Array<Record>& records, Array<Record>& scratch, const Key& key) {
    constexpr unsigned kDigitBits = 11;
    constexpr unsigned kDigits = 6;  // 66 bits
    constexpr std::uint64_t kRadix = 1U << kDigitBits;
    constexpr std::uint64_t kLeastPiece = 1 << 13;
    const std::uint64_t n = records.size();
    const std::uint64_t n_pieces =
        std::clamp<std::uint64_t>(n / kLeastPiece, 1, 4 * std::uint64_t{workers.n_threads()});
    const auto for_each_piece = [&](const auto& body) {
        workers.for_ranges(n_pieces, 1, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t p = begin; p < end; ++p) {
                body(p, p * n / n_pieces, (p + 1) * n / n_pieces);
            }
        });
    };
    // A key of fewer bits must not be shifted by more than it has.
    const auto digit = [&](const Record& r, unsigned d) {
        return static_cast<std::uint64_t>(key(r)) >> (d * kDigitBits) & (kRadix - 1);
    };
    std::atomic<std::uint64_t> differing{0};  // bits that are not the same in all keys
    for_each_piece([&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
        std::uint64_t bits = 0;
        for (std::uint64_t i = begin; i < end; ++i) {
            bits |= static_cast<std::uint64_t>(key(records[i])) ^
                    static_cast<std::uint64_t>(key(records[0]));
        }
        differing |= bits;
    });
    std::vector<std::array<std::uint64_t, kRadix>> places(n_pieces);
    for (unsigned d = 0; d < kDigits; ++d) {
        if ((differing >> (d * kDigitBits) & (kRadix - 1)) == 0) continue;
        for_each_piece([&](std::uint64_t p, std::uint64_t begin, std::uint64_t end) {
            places[p].fill(0);
            for (std::uint64_t i = begin; i < end; ++i) ++places[p][digit(records[i], d)];
        });
        std::uint64_t sum = 0;
        for (std::uint64_t i = 0; i < kRadix; ++i) {
            for (auto& place : places) sum += std::exchange(place[i], sum);
        }
        for_each_piece([&](std::uint64_t p, std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t i = begin; i < end; ++i) {
                scratch[places[p][digit(records[i], d)]++] = records[i];
            }
        });
        std::swap(records, scratch);
    }
}

}  // namespace hewer::ooc
