// SPDX-License-Identifier: MIT
/// A pseudo-random order of any number of things, computed instead of stored.
#pragma once

#include <array>
#include <cstdint>

#include "streaming/lattice_noise.h"

namespace hewer::streaming {

/// A bijection of [0, size) and its inverse, each in constant time and memory.
///
/// A Feistel network on pairs (left, right) of two nearly equal ranges whose product exceeds `size`
/// by less than one of them; results past the end are sent through again (Black & Rogaway 2002,
/// "cycle walking"), which therefore almost never happens. Not cryptographic.
/// size must lie in 1 .. 2^34.
class Permutation {
  public:
    Permutation(std::uint64_t size, std::uint64_t seed);

    [[nodiscard]] std::uint64_t operator()(std::uint64_t i) const {
        do i = forward(i);
        while (i >= size_);
        return i;
    }
    [[nodiscard]] std::uint64_t inverse(std::uint64_t i) const {
        do i = backward(i);
        while (i >= size_);
        return i;
    }

  private:
    static constexpr std::size_t kRounds = 6;

    /// A number below `range` that depends on `value` and the round.
    [[nodiscard]] std::uint32_t scramble(std::size_t round, std::uint32_t value,
                                         std::uint32_t range) const {
        const std::uint64_t h = mix_bits(value ^ keys_[round]);
        return static_cast<std::uint32_t>(((h >> 32) * range) >> 32);
    }
    [[nodiscard]] std::uint64_t forward(std::uint64_t i) const {
        auto left = static_cast<std::uint32_t>(i / right_size_);
        auto right = static_cast<std::uint32_t>(i % right_size_);
        for (std::size_t round = 0; round < kRounds; round += 2) {
            left += scramble(round, right, left_size_);
            if (left >= left_size_) left -= left_size_;
            right += scramble(round + 1, left, right_size_);
            if (right >= right_size_) right -= right_size_;
        }
        return std::uint64_t{left} * right_size_ + right;
    }
    [[nodiscard]] std::uint64_t backward(std::uint64_t i) const {
        auto left = static_cast<std::uint32_t>(i / right_size_);
        auto right = static_cast<std::uint32_t>(i % right_size_);
        for (std::size_t round = kRounds; round > 0; round -= 2) {
            right += right_size_ - scramble(round - 1, left, right_size_);
            if (right >= right_size_) right -= right_size_;
            left += left_size_ - scramble(round - 2, right, left_size_);
            if (left >= left_size_) left -= left_size_;
        }
        return std::uint64_t{left} * right_size_ + right;
    }

    std::uint64_t size_;
    std::uint32_t left_size_;
    std::uint32_t right_size_;
    std::array<std::uint64_t, kRounds> keys_{};
};

}  // namespace hewer::streaming
