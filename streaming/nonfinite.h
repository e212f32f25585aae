// SPDX-License-Identifier: MIT
/// A test for NaN and infinity that costs a few integer operations and no branch.
#pragma once

#include <cstdint>
#include <cstring>

namespace hewer::streaming {

/// Collects doubles; any() afterwards tells whether one of them was not finite. Adding one to the
/// exponent field carries into the sign bit only if all its bits are set.
class NonfiniteProbe {
  public:
    void add(double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        bits_ |= (bits & 0x7FF0000000000000ULL) + 0x0010000000000000ULL;
    }
    [[nodiscard]] bool any() const { return (bits_ >> 63) != 0; }

  private:
    std::uint64_t bits_ = 0;
};

}  // namespace hewer::streaming
