// SPDX-License-Identifier: MIT
/// Single records of a spool, for readers that stay near where they have been.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/spool.h"

namespace hewer::ooc {

/// Keeps the last lines of records that were asked for, direct-mapped. One thread. The spool's
/// records must not change any more. Memory: kBytes.
template <typename T>
class SpoolCache {
  public:
    static constexpr std::uint64_t kLines = 64;
    static constexpr std::uint64_t kLineBytes = 4096;
    static constexpr std::uint64_t kBytes = kLines * (kLineBytes + sizeof(std::uint64_t));

    explicit SpoolCache(const Spool<T>& spool)
        : spool_(&spool), lines_(kLines, kNone), records_(kLines * kPerLine) {}

    const T& at(std::uint64_t i) {
        const std::uint64_t line = i / kPerLine;
        const std::uint64_t slot = line % kLines;
        T* const records = records_.data() + slot * kPerLine;
        if (lines_[slot] != line) {
            const std::uint64_t first = line * kPerLine;
            spool_->read(first, std::span<T>(records, std::min(kPerLine, spool_->size() - first)));
            lines_[slot] = line;
        }
        return records[i % kPerLine];
    }

  private:
    static constexpr std::uint64_t kPerLine = kLineBytes / sizeof(T);
    static constexpr std::uint64_t kNone = ~std::uint64_t{0};
    const Spool<T>* spool_;
    std::vector<std::uint64_t> lines_;
    std::vector<T> records_;
};

}  // namespace hewer::ooc
