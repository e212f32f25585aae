// SPDX-License-Identifier: MIT
/// A set of ids that gives its members numbers of their own.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

#include "ooc/array.h"

namespace hewer::ooc {

/// A subset of 0 .. n - 1, in which the rank of a member is the number of members below it.
/// Memory: 9 bytes for 64 ids. One thread while it grows, then any.
class RankedSet {
  public:
    RankedSet() = default;
    /// Throws OutOfMemoryBudget naming `what`.
    RankedSet(MemoryBudget& budget, std::string_view what, std::uint64_t n_ids)
        : bits_(budget, what, n_ids / kWordBits + 1),
          before_(budget, what, bits_.size() / kWordsPerRank + 1) {}

    void insert(std::uint64_t id) { bits_[id / kWordBits] |= std::uint64_t{1} << (id % kWordBits); }
    [[nodiscard]] bool has(std::uint64_t id) const {
        return (bits_[id / kWordBits] >> (id % kWordBits) & 1) != 0;
    }

    /// After the last insert(), before the first rank(). Returns the size.
    std::uint64_t number() {
        std::uint64_t n = 0;
        for (std::uint64_t i = 0; i < bits_.size(); ++i) {
            if (i % kWordsPerRank == 0) before_[i / kWordsPerRank] = n;
            n += static_cast<std::uint64_t>(std::popcount(bits_[i]));
        }
        return n;
    }
    /// How many members are below `id`, which need not be one.
    [[nodiscard]] std::uint64_t rank(std::uint64_t id) const {
        const std::uint64_t word = id / kWordBits;
        const std::uint64_t group = word / kWordsPerRank;
        std::uint64_t n = before_[group];
        for (std::uint64_t i = group * kWordsPerRank; i < word; ++i) {
            n += static_cast<std::uint64_t>(std::popcount(bits_[i]));
        }
        const std::uint64_t below = (std::uint64_t{1} << (id % kWordBits)) - 1;
        return n + static_cast<std::uint64_t>(std::popcount(bits_[word] & below));
    }

  private:
    static constexpr std::uint64_t kWordBits = 64;
    static constexpr std::uint64_t kWordsPerRank = 8;
    Array<std::uint64_t> bits_;
    Array<std::uint64_t> before_;  // members before each group of words
};

}  // namespace hewer::ooc
