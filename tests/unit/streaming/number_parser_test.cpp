// SPDX-License-Identifier: MIT
#include "streaming/number_parser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace hewer::streaming {
namespace {

const unsigned char* bytes(const std::string& text) {
    return reinterpret_cast<const unsigned char*>(text.c_str());
}

TEST(NumberParser, RoundsAsTheStandardLibraryDoes) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 200000; ++i) {
        std::string text;
        if (random() % 2 == 0) text += '-';
        const int n_digits = 1 + static_cast<int>(random() % 22);
        const int point = static_cast<int>(random() % 24);
        for (int k = 0; k < n_digits; ++k) {
            if (k == point) text += '.';
            text += static_cast<char>('0' + random() % 10);
        }
        if (random() % 2 == 0) text += "e" + std::to_string(static_cast<int>(random() % 660) - 330);
        const std::string token = text + " ";
        double value = 0;
        ASSERT_EQ(parse_double(bytes(token), value), bytes(token) + text.size()) << text;
        ASSERT_EQ(value, std::strtod(text.c_str(), nullptr)) << text;
    }
}

TEST(NumberParser, RefusesWhatIsNoNumber) {
    for (const char* text :
         {"x ", "- ", ". ", "1e ", "1e+ ", "1.2.3 ", "1,5 ", "0x10 ", "--1 ", "+-1 ", "1-2 "}) {
        double value = 0;
        EXPECT_EQ(parse_double(bytes(text), value), nullptr) << text;
    }
    for (const char* text : {"x ", "- ", "1.0 ", "1e3 ", "9999999999999999999 ", "+-1 "}) {
        std::int64_t value = 0;
        EXPECT_EQ(parse_integer(bytes(text), value), nullptr) << text;
    }
}

TEST(NumberParser, KnowsSpecialValues) {
    double value = 0;
    for (const char* text : {"nan ", "NaN ", "-nan ", "1.#QNAN "}) {
        ASSERT_NE(parse_double(bytes(text), value), nullptr) << text;
        EXPECT_TRUE(std::isnan(value)) << text;
    }
    for (const char* text : {"inf ", "+Infinity ", "1e99999 ", "1e400 "}) {
        ASSERT_NE(parse_double(bytes(text), value), nullptr) << text;
        EXPECT_EQ(value, HUGE_VAL) << text;
    }
    ASSERT_NE(parse_double(bytes("-1e-99999 "), value), nullptr);
    EXPECT_EQ(value, 0.0);
}

/// Where skip_tokens() must end, byte by byte; null the same way.
const unsigned char* skip_one_by_one(const unsigned char* p, const unsigned char* end,
                                     std::uint64_t n) {
    for (; n > 0; --n) {
        p = skip_blanks(p, end);
        while (p != end && !is_blank(*p)) ++p;
        if (p == end) return nullptr;
    }
    return p;
}

TEST(NumberParser, SkipsTokensOfAnyLengthBetweenAnyBlanks) {
    std::mt19937_64 random(2);
    const std::string alphabet = std::string(" \n\r\t !~\x7f\x80\xff") + '\0' + "0159.-e";
    for (int i = 0; i < 20000; ++i) {
        std::string text;
        const std::size_t length = random() % 60;
        while (text.size() < length) {
            // Runs, so that tokens and gaps longer than a word are among them.
            text += std::string(1 + random() % (random() % 4 == 0 ? 20 : 3),
                                alphabet[random() % alphabet.size()]);
        }
        const unsigned char* const begin = bytes(text);
        const unsigned char* const end = begin + text.size();
        std::uint64_t n = 0;
        for (; skip_one_by_one(begin, end, n) != nullptr; ++n) {
            ASSERT_EQ(skip_tokens(begin, end, n), skip_one_by_one(begin, end, n)) << n;
        }
        ASSERT_EQ(skip_tokens(begin, end, n), nullptr);
        ASSERT_EQ(count_tokens(begin, end), n - 1);
    }
}

TEST(NumberParser, CountsAByteInTextOfAnyLength) {
    std::mt19937_64 random(3);
    for (std::size_t length = 0; length < 1200; ++length) {
        std::string text(length, '\n');
        // None of it, some of it, all of it: sums of one byte must not run over.
        for (char& c : text) {
            if (random() % 3 < length % 3) c = 'x';
        }
        const unsigned char* const begin = bytes(text);
        ASSERT_EQ(count_byte(begin, begin + length, '\n'),
                  static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')));
    }
}

}  // namespace
}  // namespace hewer::streaming
