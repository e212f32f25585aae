// SPDX-License-Identifier: MIT
/// Numbers in text, fast. A token is a run of bytes above ' ' and must be followed by a blank: the
/// readers see to that, so no loop here needs a second end condition.
#pragma once

#include <cstdint>

namespace hewer::streaming {

/// All bytes up to and including the space separate tokens.
constexpr bool is_blank(unsigned char c) {
    return c <= ' ';
}

inline const unsigned char* skip_blanks(const unsigned char* p, const unsigned char* end) {
    while (p != end && is_blank(*p)) ++p;
    return p;
}

/// The place after `n` more tokens, or null if the `n`th is not followed by a blank before `end`.
inline const unsigned char* skip_tokens(const unsigned char* p, const unsigned char* end,
                                        std::uint64_t n) {
    for (; n > 0; --n) {
        while (p != end && is_blank(*p)) ++p;
        while (p != end && !is_blank(*p)) ++p;
        if (p == end) return nullptr;
    }
    return p;
}

/// Parses the decimal integer that begins at `p`. Returns the place after it; null if the token is
/// something else or does not fit.
const unsigned char* parse_integer(const unsigned char* p, std::int64_t& value);

/// Parses the number that begins at `p`, correctly rounded; also inf and nan as C and Microsoft's
/// library print them. Too large a number becomes infinite, too small a one 0. Returns the place
/// after it; null if the token is something else. Does not depend on the locale.
const unsigned char* parse_double(const unsigned char* p, double& value);

}  // namespace hewer::streaming
