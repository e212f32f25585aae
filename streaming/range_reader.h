// SPDX-License-Identifier: MIT
/// The bytes of a range, front to back.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "streaming/file_range.h"

namespace hewer::streaming {

/// Reads by pieces of kBytes. One thread. Throws IoError.
class RangeReader {
  public:
    static constexpr std::size_t kBytes = 64 << 10;

    explicit RangeReader(FileRange range) : range_(std::move(range)), buffer_(kBytes) {}

    /// The next piece; empty at the end of the range or of its file.
    std::span<const unsigned char> next() {
        const std::uint64_t n = std::min<std::uint64_t>(kBytes, range_.n_bytes - done_);
        const std::size_t got =
            n == 0 ? 0 : range_.file->read_at(range_.offset + done_, buffer_.data(), n);
        done_ += got;
        return {buffer_.data(), got};
    }

  private:
    FileRange range_;
    std::vector<unsigned char> buffer_;
    std::uint64_t done_ = 0;
};

}  // namespace hewer::streaming
