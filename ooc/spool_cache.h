// SPDX-License-Identifier: MIT
/// Single records of a spool, for readers that stay near where they have been.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ooc/spool.h"

namespace hewer::ooc {

/// Keeps the last lines of records that were asked for, direct-mapped. One thread. The spool may
/// grow. Memory: kBytes, or kBytes / kLines for each of `n_lines`.
template <typename T>
class SpoolCache {
  public:
    static constexpr std::uint64_t kLines = 64;
    static constexpr std::uint64_t kLineBytes = 4096;
    static constexpr std::uint64_t kBytes = kLines * (kLineBytes + 2 * sizeof(std::uint64_t));

    /// @param n_lines  a power of two.
    explicit SpoolCache(const Spool<T>& spool, std::uint64_t n_lines = kLines)
        : spool_(&spool),
          n_lines_(n_lines),
          held_(n_lines, Range{0, 0}),
          records_(std::make_unique_for_overwrite<T[]>(n_lines * kPerLine)) {}

    const T& at(std::uint64_t i) {
        const std::uint64_t line = i / kPerLine;
        const std::uint64_t slot = line & (n_lines_ - 1);
        T* const records = records_.get() + slot * kPerLine;
        Range& held = held_[slot];
        // The last line of a spool that grows is held in part only.
        if (i < held.first || i >= held.last) {
            const std::uint64_t first = line * kPerLine;
            held = {first, std::min(first + kPerLine, spool_->size())};
            spool_->read(first, std::span<T>(records, held.last - first));
        }
        return records[i - held.first];
    }

  private:
    static constexpr std::uint64_t kPerLine = kLineBytes / sizeof(T);
    struct Range {
        std::uint64_t first;
        std::uint64_t last;
    };
    const Spool<T>* spool_;
    std::uint64_t n_lines_;
    std::vector<Range> held_;
    std::unique_ptr<T[]> records_;  // untouched until they are read
};

}  // namespace hewer::ooc
