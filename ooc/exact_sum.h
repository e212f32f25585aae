// SPDX-License-Identifier: MIT
/// Sums that do not depend on the order of what is added.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hewer::ooc {

/// The sum of finite doubles of no negative sign, exact until value() rounds it: threads may add in
/// any order, and parts of a sum may be added up in any order, with equal bits in the end.
///
/// A fixed-point number over the whole range of doubles, in digits of 32 bits that are kept in 64,
/// so that carries need not be passed on before 2^31 additions (a small superaccumulator: Neal
/// 2015). 0.6 KiB; some ten instructions an addition. One thread.
class ExactSum {
  public:
    void add(double x) {
        const auto bits = std::bit_cast<std::uint64_t>(x);
        constexpr unsigned kFraction = 52;
        const std::uint64_t exponent = bits >> kFraction;
        std::uint64_t mantissa = bits & ((std::uint64_t{1} << kFraction) - 1);
        // The mantissa's lowest bit stands for 2^(place - 1074).
        std::uint64_t place = 0;
        if (exponent != 0) {
            mantissa |= std::uint64_t{1} << kFraction;
            place = exponent - 1;
        }
        const std::uint64_t digit = place / kDigitBits;
        const std::uint64_t shift = place % kDigitBits;
        const std::uint64_t low = mantissa << shift;  // its upper bits come next
        digits_[digit] += low & kDigitMask;
        digits_[digit + 1] += low >> kDigitBits;
        digits_[digit + 2] += shift == 0 ? 0 : mantissa >> (64 - shift);
        if (++n_waiting_ == kMostWaiting) pass_carries_on();
    }
    void add(const ExactSum& other) {
        ExactSum part = other;
        part.pass_carries_on();
        pass_carries_on();
        for (std::size_t i = 0; i < kDigits; ++i) digits_[i] += part.digits_[i];
        pass_carries_on();
    }

    /// Within a unit in the last place of the sum.
    [[nodiscard]] double value() const {
        ExactSum sum = *this;
        sum.pass_carries_on();
        double result = 0;
        for (std::size_t i = kDigits; i-- > 0;) {
            if (sum.digits_[i] == 0) continue;
            result += std::ldexp(static_cast<double>(sum.digits_[i]),
                                 static_cast<int>(i * kDigitBits) - 1074);
        }
        return result;
    }

  private:
    static constexpr std::uint64_t kDigitBits = 32;
    static constexpr std::uint64_t kDigitMask = 0xffffffffU;
    static constexpr std::uint64_t kMostWaiting = std::uint64_t{1} << 31;
    // 2098 bits from the lowest to the highest of a double, and 2^78 additions.
    static constexpr std::size_t kDigits = 68;

    void pass_carries_on() {
        for (std::size_t i = 0; i + 1 < kDigits; ++i) {
            digits_[i + 1] += digits_[i] >> kDigitBits;
            digits_[i] &= kDigitMask;
        }
        n_waiting_ = 0;
    }

    std::array<std::uint64_t, kDigits> digits_{};
    std::uint64_t n_waiting_ = 0;
};

}  // namespace hewer::ooc
