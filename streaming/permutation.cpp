// SPDX-License-Identifier: MIT
#include "streaming/permutation.h"

#include <cmath>

namespace hewer::streaming {

Permutation::Permutation(std::uint64_t size, std::uint64_t seed) : size_(size) {
    right_size_ = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(size))) + 1;
    left_size_ = static_cast<std::uint32_t>((size + right_size_ - 1) / right_size_);
    for (std::size_t round = 0; round < kRounds; ++round) {
        keys_[round] = mix_bits(seed + 0x9e3779b97f4a7c15ULL * (round + 1));
    }
}

}  // namespace hewer::streaming
