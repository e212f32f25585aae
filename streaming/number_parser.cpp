// SPDX-License-Identifier: MIT
#include "streaming/number_parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <string_view>

namespace hewer::streaming {

namespace {

/// What the fast path leaves: long mantissas, large exponents, inf, nan, and what is no number.
const unsigned char* parse_any_double(const unsigned char* p, double& value) {
    const unsigned char* token_end = p;
    while (!is_blank(*token_end)) ++token_end;
    std::string_view token(reinterpret_cast<const char*>(p),
                           static_cast<std::size_t>(token_end - p));
    if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc::result_out_of_range) {
        const std::size_t e = token.find_first_of("eE");
        const bool is_tiny = e != token.npos ? token[e + 1] == '-'
                                             : token.find_first_not_of("-0") == token.find('.');
        value = is_tiny ? 0.0 : std::numeric_limits<double>::infinity();
        if (token[0] == '-') value = -value;
        return token_end;
    }
    if (error == std::errc() && end == token.data() + token.size()) return token_end;
    // "1.#QNAN", "-1.#IND", "1.#INF00"
    if (token.find(".#") != token.npos) {
        value = std::numeric_limits<double>::quiet_NaN();
        return token_end;
    }
    return nullptr;
}

}  // namespace

// Clinger 1990: with a mantissa below 2^53 and a power of ten that a double holds exactly, one
// multiplication or division rounds correctly.
const unsigned char* parse_double(const unsigned char* p, double& value) {
    static constexpr std::array<double, 23> kPowers{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const unsigned char* const token = p;
    const bool is_negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;
    const unsigned char* first = p;
    std::uint64_t mantissa = 0;
    for (; is_digit(*p); ++p) mantissa = mantissa * 10 + static_cast<unsigned>(*p - '0');
    std::int64_t n_digits = p - first;
    std::int64_t exponent = 0;
    if (*p == '.') {
        first = ++p;
        for (; is_digit(*p); ++p) mantissa = mantissa * 10 + static_cast<unsigned>(*p - '0');
        exponent = first - p;
        n_digits -= exponent;
    }
    if (n_digits == 0 || n_digits > 19) return parse_any_double(token, value);
    if (*p == 'e' || *p == 'E') {
        ++p;
        const bool is_down = *p == '-';
        if (*p == '-' || *p == '+') ++p;
        first = p;
        std::int64_t power = 0;
        for (; is_digit(*p) && p - first < 4; ++p) power = power * 10 + (*p - '0');
        if (p == first) return parse_any_double(token, value);
        exponent += is_down ? -power : power;
    }
    if (!is_blank(*p) || mantissa > (1ULL << 53) || exponent < -22 || exponent > 22) {
        return parse_any_double(token, value);
    }
    const double whole = static_cast<double>(mantissa);
    const double power = kPowers[static_cast<std::size_t>(std::abs(exponent))];
    const double magnitude = exponent < 0 ? whole / power : whole * power;
    value = is_negative ? -magnitude : magnitude;
    return p;
}

}  // namespace hewer::streaming
