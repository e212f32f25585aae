// SPDX-License-Identifier: MIT
/// Words of one line, for parsers of text chunks. Every line ends with a line end, the last of a
/// chunk too.
#pragma once

#include <array>
#include <cstring>
#include <string>

#include "hewer/types.h"
#include "streaming/nonfinite.h"
#include "streaming/number_parser.h"
#include "streaming/text_chunks.h"

namespace hewer::streaming {

/// The next token of the line, or its end.
inline const unsigned char* skip_blanks_in_line(const unsigned char* p, unsigned char line_end) {
    while (is_blank(*p) && *p != line_end) ++p;
    return p;
}

/// The end of the token at `p`.
inline const unsigned char* token_end(const unsigned char* p) {
    while (!is_blank(*p)) ++p;
    return p;
}

/// The end of the line; `end` is that of the chunk.
inline const unsigned char* find_line_end(const unsigned char* p, const unsigned char* end,
                                          unsigned char line_end) {
    const void* const found = std::memchr(p, line_end, static_cast<std::size_t>(end - p));
    return found != nullptr ? static_cast<const unsigned char*>(found) : end;
}

[[noreturn]] inline void refuse_number(const unsigned char* p, const TextChunk& chunk,
                                       const char* wanted) {
    const std::string token = quote_token(p, chunk.end());
    const bool is_end = p == chunk.end() || *p == chunk.line_end;
    throw TextProblem{p, is_end ? std::string("the line ends where ") + wanted + " should stand"
                                : token + " is not " + wanted +
                                      (token.find(',') != token.npos
                                           ? "; decimals and lists with commas are not read"
                                           : "")};
}

/// The number at or after `p`, which must be on the same line. Throws TextProblem.
inline const unsigned char* read_double(const unsigned char* p, const TextChunk& chunk,
                                        double& value) {
    p = skip_blanks_in_line(p, chunk.line_end);
    const unsigned char* const end = *p != chunk.line_end ? parse_double(p, value) : nullptr;
    if (end == nullptr) refuse_number(p, chunk, "a number");
    return end;
}

/// Three numbers as a direction; none, that is zero, if one of them is not finite.
inline std::array<float, 3> to_normal(const double* numbers) {
    std::array<float, 3> normal{};
    NonfiniteProbe probe;
    for (std::size_t i = 0; i < 3; ++i) {
        normal[i] = static_cast<float>(numbers[i]);
        probe.add(static_cast<double>(normal[i]));
    }
    return probe.any() ? std::array<float, 3>{} : normal;
}

/// The next three numbers as a position.
inline const unsigned char* read_position(const unsigned char* p, const TextChunk& chunk,
                                          Vec3& position, bool& is_finite) {
    NonfiniteProbe probe;
    for (double& x : position) {
        p = read_double(p, chunk, x);
        probe.add(x);
    }
    is_finite = !probe.any();
    return p;
}

}  // namespace hewer::streaming
