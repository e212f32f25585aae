// SPDX-License-Identifier: MIT
#include "app/parse_units.h"

#include <gtest/gtest.h>

#include "hewer/error.h"

namespace hewer::app {
namespace {

TEST(ParseCount, takes_decimal_multiples_exactly) {
    EXPECT_EQ(parse_count("0"), 0U);
    EXPECT_EQ(parse_count("250000"), 250'000U);
    EXPECT_EQ(parse_count("250k"), 250'000U);
    EXPECT_EQ(parse_count("1.5M"), 1'500'000U);
    EXPECT_EQ(parse_count(".5k"), 500U);
    EXPECT_EQ(parse_count("2G"), 2'000'000'000U);
    EXPECT_EQ(parse_count("1.500k"), 1'500U);
    EXPECT_EQ(parse_count("18446744073709551615"), 18446744073709551615U);
}

TEST(ParseCount, refuses_everything_else) {
    for (const char* text :
         {"", "k", ".", "-1", "+1", "1.5", "1.0001k", "1m", "1e6", "1,000", "5%", " 5", "5 ",
          "0x10", "18446744073709551616", "18446744073709552k", "0.00000000000000000001G"}) {
        EXPECT_THROW(parse_count(text), InvalidArgument) << text;
    }
}

TEST(ParseBytes, takes_powers_of_1024) {
    EXPECT_EQ(parse_bytes("65536"), 65536U);
    EXPECT_EQ(parse_bytes("64K"), 65536U);
    EXPECT_EQ(parse_bytes("512M"), 512ULL << 20);
    EXPECT_EQ(parse_bytes("512MiB"), 512ULL << 20);
    EXPECT_EQ(parse_bytes("1.5GiB"), 3ULL << 29);
    EXPECT_EQ(parse_bytes("2T"), 2ULL << 40);
    EXPECT_EQ(parse_bytes("0.1K"), 102U) << "cut off";
}

TEST(ParseBytes, refuses_decimal_units_and_the_rest) {
    for (const char* text : {"", "M", "1MB", "1GB", "1kB", "1.5", "-1M", "1Mib", "20000000T"}) {
        EXPECT_THROW(parse_bytes(text), InvalidArgument) << text;
    }
}

TEST(ParseRatio, takes_percent_and_fractions) {
    EXPECT_DOUBLE_EQ(parse_ratio("5%"), 0.05);
    EXPECT_DOUBLE_EQ(parse_ratio("0.05"), 0.05);
    EXPECT_DOUBLE_EQ(parse_ratio("100%"), 1.0);
    EXPECT_DOUBLE_EQ(parse_ratio("0.5%"), 0.005);
}

TEST(ParseRatio, refuses_what_may_mean_two_things) {
    for (const char* text : {"5", "1", "1.5", "0", "0%", "101%", "-5%", "%", "nan", "inf", "x"}) {
        EXPECT_THROW(parse_ratio(text), InvalidArgument) << text;
    }
}

TEST(ParseError, tells_units_from_percent) {
    EXPECT_EQ(parse_error("0.5").kind, Target::Kind::Error);
    EXPECT_DOUBLE_EQ(parse_error("0.5").value, 0.5);
    EXPECT_EQ(parse_error("0.01%").kind, Target::Kind::RelativeError);
    EXPECT_DOUBLE_EQ(parse_error("0.01%").value, 1e-4);
    for (const char* text : {"0", "-1", "0%", "inf", "", "5k"}) {
        EXPECT_THROW(parse_error(text), InvalidArgument) << text;
    }
}

TEST(ParseLods, takes_counts_or_ratios_from_fine_to_coarse) {
    const auto counts = parse_lods("1M,250k,60k");
    ASSERT_EQ(counts.size(), 3U);
    EXPECT_EQ(counts[1].kind, Target::Kind::Triangles);
    EXPECT_EQ(counts[1].value, 250'000);
    const auto ratios = parse_lods("10%,0.02,0.5%");
    ASSERT_EQ(ratios.size(), 3U);
    EXPECT_EQ(ratios[1].kind, Target::Kind::Ratio);
    EXPECT_DOUBLE_EQ(ratios[1].value, 0.02);
    EXPECT_EQ(parse_lods("1.5k,1k")[0].kind, Target::Kind::Triangles);
}

TEST(ParseLods, refuses_mixtures_and_wrong_orders) {
    for (const char* text : {"1M", "1k,2k", "1k,1k", "1k,5%", "", "1k,", ",1k", "2k,0"}) {
        EXPECT_THROW(parse_lods(text), InvalidArgument) << text;
    }
}

TEST(ParseBox, takes_two_corners) {
    const Bounds box = parse_box("-1,0,0.5,1,0,2e3");
    EXPECT_EQ(box.min, (Vec3{-1, 0, 0.5}));
    EXPECT_EQ(box.max, (Vec3{1, 0, 2000}));
    for (const char* text : {"", "1,2,3", "0,0,0,1,1,1,1", "1,0,0,0,1,1", "0,0,0,0,0,0",
                             "0,0,0,1,1,nan", "0,0,0,1,1,x"}) {
        EXPECT_THROW(parse_box(text), InvalidArgument) << text;
    }
}

TEST(ParsePixels, takes_width_and_height) {
    EXPECT_EQ(parse_pixels("1920x1080"), (std::array<std::uint64_t, 2>{1920, 1080}));
    for (const char* text : {"1920", "x", "1920x", "1x2x3", "-1x2"}) {
        EXPECT_THROW(parse_pixels(text), InvalidArgument) << text;
    }
}

}  // namespace
}  // namespace hewer::app
