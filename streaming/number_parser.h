// SPDX-License-Identifier: MIT
/// Numbers in text, fast. A token is a run of bytes above ' ' and must be followed by a blank: the
/// readers see to that, so no loop here needs a second end condition.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

namespace hewer::streaming {

/// All bytes up to and including the space separate tokens.
constexpr bool is_blank(unsigned char c) {
    return c <= ' ';
}

constexpr bool is_digit(unsigned char c) {
    return static_cast<unsigned char>(c - '0') < 10;
}

inline const unsigned char* skip_blanks(const unsigned char* p, const unsigned char* end) {
    while (p != end && is_blank(*p)) ++p;
    return p;
}

/// Where tokens end in text that is walked through eight bytes at a time: byte by byte, their
/// lengths are what a processor guesses worst.
class TokenEnds {
  public:
    /// In the bytes from `p` on, which follow those of the call before: the top bit of each blank
    /// that follows a token.
    std::uint64_t next(const unsigned char* p) {
        std::uint64_t bytes;
        std::memcpy(&bytes, p, sizeof bytes);
        if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
        // Above ' ' is what has its top bit set, or gets it when '~' - ' ' + 1 is added to the
        // rest.
        const std::uint64_t in_token = (((bytes & ~kTop) + 0x5f * kOnes) | bytes) & kTop;
        const std::uint64_t ends = ~in_token & kTop & (in_token << 8 | in_token_before_);
        in_token_before_ = in_token >> 56;
        return ends;
    }
    /// How many of them next() has found.
    static std::uint64_t count(std::uint64_t ends) { return (ends >> 7) * kOnes >> 56; }

  private:
    static constexpr std::uint64_t kOnes = 0x0101010101010101;
    static constexpr std::uint64_t kTop = 0x80 * kOnes;
    std::uint64_t in_token_before_ = 0;
};

/// Tokens that are followed by a blank before `end`; `p` is not within one.
inline std::uint64_t count_tokens(const unsigned char* p, const unsigned char* end) {
    std::uint64_t n = 0;
    TokenEnds ends;
    for (; end - p >= 8; p += 8) n += TokenEnds::count(ends.next(p));
    std::array<unsigned char, 8> last;
    last.fill('x');  // what is not there follows no token
    std::copy(p, end, last.begin());
    return n + TokenEnds::count(ends.next(last.data()));
}

/// The place after `n` more tokens, or null if the `n`th is not followed by a blank before `end`.
/// `p` is not within a token.
inline const unsigned char* skip_tokens(const unsigned char* p, const unsigned char* end,
                                        std::uint64_t n) {
    if (n == 0) return p;
    TokenEnds ends;
    for (; end - p >= 8; p += 8) {
        std::uint64_t found = ends.next(p);
        const std::uint64_t n_found = TokenEnds::count(found);
        if (n_found < n) {
            n -= n_found;
            continue;
        }
        for (; n > 1; --n) found &= found - 1;
        return p + std::countr_zero(found) / 8;
    }
    std::array<unsigned char, 8> last;
    last.fill('x');
    std::copy(p, end, last.begin());
    std::uint64_t found = ends.next(last.data());
    if (TokenEnds::count(found) < n) return nullptr;
    for (; n > 1; --n) found &= found - 1;
    return p + std::countr_zero(found) / 8;
}

/// How often `byte` occurs. In sums of one byte, which a vector has many of; std::count() widens
/// each.
inline std::uint64_t count_byte(const unsigned char* p, const unsigned char* end,
                                unsigned char byte) {
    constexpr std::ptrdiff_t kPiece = 255;  // what such a sum can hold
    std::uint64_t n = 0;
    while (p != end) {
        const unsigned char* const piece_end = p + std::min(end - p, kPiece);
        std::uint8_t found = 0;
        for (; p != piece_end; ++p) found = static_cast<std::uint8_t>(found + (*p == byte ? 1 : 0));
        n += found;
    }
    return n;
}

/// Parses the decimal integer that begins at `p`. Returns the place after it; null if the token is
/// something else or does not fit. Inline: a mesh has four of them in each row.
inline const unsigned char* parse_integer(const unsigned char* p, std::int64_t& value) {
    const bool is_negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;
    const unsigned char* const first = p;
    std::uint64_t magnitude = 0;
    for (; is_digit(*p); ++p) magnitude = magnitude * 10 + static_cast<unsigned>(*p - '0');
    // 18 digits always fit; longer ones are no count or id of anything, leading zeros aside.
    if (p == first || p - first > 18 || !is_blank(*p)) return nullptr;
    value =
        is_negative ? -static_cast<std::int64_t>(magnitude) : static_cast<std::int64_t>(magnitude);
    return p;
}

/// Parses the number that begins at `p`, correctly rounded; also inf and nan as C and Microsoft's
/// library print them. Too large a number becomes infinite, too small a one 0. Returns the place
/// after it; null if the token is something else. Does not depend on the locale.
const unsigned char* parse_double(const unsigned char* p, double& value);

}  // namespace hewer::streaming
