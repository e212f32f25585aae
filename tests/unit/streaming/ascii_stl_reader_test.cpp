// SPDX-License-Identifier: MIT
#include "streaming/ascii_stl_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/streaming/text_reading.h"

namespace hewer {
namespace {

using streaming::open_ascii_stl;
using tests::expect_words;
using tests::TextResult;
using Soup = std::vector<std::array<Vec3, 3>>;

TextResult read(const std::string& text, bool is_strict = false) {
    return tests::read_in_all_ways(open_ascii_stl, text, {.strict = is_strict});
}

/// Seven lines, with `x` as the first coordinate.
std::string facet(const std::string& x) {
    return " facet normal 0 0 1\n  outer loop\n   vertex " + x +
           " 0 0\n   vertex 1 0.5 0\n   vertex 0 1 -25e-2\n  endloop\n endfacet\n";
}

std::array<Vec3, 3> triangle(double x) {
    return {{{x, 0, 0}, {1, 0.5, 0}, {0, 1, -0.25}}};
}

TEST(AsciiStlReader, ReadsASoup) {
    const TextResult result =
        read("solid a name\n" + facet("0") + facet("2.5") + facet("-1e3") + "endsolid a name\n");
    EXPECT_EQ(result.error, "");
    EXPECT_EQ(result.back.soup, (Soup{triangle(0), triangle(2.5), triangle(-1000)}));
    EXPECT_FALSE(result.info.is_indexed);
    EXPECT_EQ(result.info.n_faces, 3U);
    EXPECT_EQ(result.info.format, "STL, ASCII");
    EXPECT_TRUE(result.info.ignored.empty());
}

TEST(AsciiStlReader, ReadsSeveralSolidsOfAnyName) {
    const TextResult result =
        read("solid\n" + facet("0") + "endsolid\n\nsolid facet normal vertex endfacet\n" +
             facet("1") + "endsolid facet normal\nsolid empty\nendsolid empty\nsolid endfacet\n" +
             facet("2") + "endsolid");
    EXPECT_EQ(result.error, "");
    EXPECT_EQ(result.back.soup, (Soup{triangle(0), triangle(1), triangle(2)}));
    EXPECT_TRUE(result.info.ignored.empty());
}

TEST(AsciiStlReader, TakesCapitalsTabsAndAnyLineEnd) {
    const std::string good = "solid X\n" + facet("0") + facet("3") + "endsolid X\n";
    const Soup soup{triangle(0), triangle(3)};
    std::string capitals = good;
    std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    std::string tabs = good;
    std::replace(tabs.begin(), tabs.end(), ' ', '\t');
    std::string crs = good;
    std::replace(crs.begin(), crs.end(), '\n', '\r');
    std::string crlfs;
    for (const char c : good) crlfs += c == '\n' ? std::string("\r\n") : std::string(1, c);
    std::string one_line = good.substr(8);
    std::replace(one_line.begin(), one_line.end(), '\n', ' ');
    for (const std::string& text : {good, capitals, tabs, crs, crlfs, "solid X\n" + one_line,
                                    "\xEF\xBB\xBF" + good, good.substr(0, good.size() - 1)}) {
        const TextResult result = read(text);
        EXPECT_EQ(result.error, "") << text;
        EXPECT_EQ(result.back.soup, soup) << text;
        EXPECT_TRUE(result.info.ignored.empty()) << text;
        const test::TempDir dir;
        EXPECT_EQ(open_mesh(dir.write("x", text))->info().format, "STL, ASCII") << text;
    }
}

TEST(AsciiStlReader, TakesNormalsThatAreNoNumbersOrMissing) {
    std::string text = "solid\n" + facet("0") + facet("1") + "endsolid\n";
    text.replace(text.find("0 0 1"), 5, "-nan 1.#IND nan");
    text.replace(text.rfind(" normal 0 0 1"), 13, "");
    EXPECT_EQ(read(text).back.soup, (Soup{triangle(0), triangle(1)}));
}

TEST(AsciiStlReader, NamesColoursOfFacets) {
    const TextResult result =
        read("solid\ncolor 1 0 0\n" + facet("0") + "color 0 1 0\n" + facet("1") + "endsolid\n");
    EXPECT_EQ(result.back.soup, (Soup{triangle(0), triangle(1)}));
    EXPECT_EQ(result.info.ignored, std::vector<std::string>{"colours of facets"});
}

TEST(AsciiStlReader, LoopsOfOtherSizesAreFannedOrLeftOut) {
    std::string four = facet("0");
    four.insert(four.find("  endloop"), "   vertex -1 0.5 0\n");
    std::string two = facet("0");
    two.replace(two.find("   vertex 0 1"), two.find("  endloop") - two.find("   vertex 0 1"), "");
    const std::string text = "solid\n" + four + two + facet("1") + "endsolid\n";
    const TextResult result = read(text);
    EXPECT_EQ(result.back.soup,
              (Soup{triangle(0), {{{0, 0, 0}, {0, 1, -0.25}, {-1, 0.5, 0}}}, triangle(1)}));
    EXPECT_EQ(result.back.defects.polygons, 1U);
    EXPECT_EQ(result.back.defects.short_faces, 1U);
    expect_words(read(text, true), {"face 1 (line 10)", "fewer than three", "strict"});
}

TEST(AsciiStlReader, DropsAndCountsTrianglesThatAreNotFinite) {
    const std::string text = "solid\n" + facet("0") + facet("nan") + facet("1e999") + facet("1") +
                             facet("-1.#INF") + "endsolid\n";
    const TextResult result = read(text);
    EXPECT_EQ(result.back.soup, (Soup{triangle(0), triangle(1)}));
    EXPECT_EQ(result.back.defects.nonfinite_triangles, 3U);
    EXPECT_EQ(result.back.defects.first_nonfinite, "triangle 1 (line 9)");
    expect_words(read(text, true), {"triangle 1 (line 9)", "not finite", "strict"});
}

TEST(AsciiStlReader, SaysWhereAFileIsCutShort) {
    const std::string good = "solid x\n" + facet("0") + facet("1") + "endsolid x\n";
    const std::size_t body = 8 + facet("0").size();
    for (const std::size_t n : {3U, 30U, 45U, 60U, 100U}) {
        const TextResult result = read(good.substr(0, body + n));
        EXPECT_FALSE(result.error.empty()) << n;
        EXPECT_NE(result.error.find("input: line "), std::string::npos) << result.error;
    }
    expect_words(read(good.substr(0, body + 22)), {"line 10", "truncated", "within a facet"});
    // Between two facets: whether it is cut is not known.
    const TextResult result = read(good.substr(0, body));
    EXPECT_EQ(result.back.soup, Soup{triangle(0)});
    ASSERT_EQ(result.info.ignored.size(), 1U);
    EXPECT_NE(result.info.ignored[0].find("cut short"), std::string::npos);
}

TEST(AsciiStlReader, SaysWhatItCannotReadAndWhere) {
    const auto refused = [](const std::string& from, const std::string& to,
                            const std::vector<std::string>& words) {
        std::string text = "solid x\n" + facet("0") + facet("1") + "endsolid x\n";
        const TextResult result = read(text.replace(text.find(from), from.size(), to));
        expect_words(result, words);
    };
    refused("vertex 0 0 0", "vertex 0 0", {"line 5", "'vertex' is not a number"});
    refused("vertex 0 0 0", "vertex 0 0,5 0", {"line 4", "'0,5' is not a number", "commas"});
    refused("vertex 0 0 0", "vertex 0 0 0 0", {"line 4", "'0'", "'endloop'"});
    refused("outer loop", "inner loop", {"line 3", "'inner'", "'outer'"});
    refused("endfacet", "endfacets", {"line 8", "'endfacets'", "'endfacet'"});
    refused(" facet normal", " facets normal", {"line 2", "'facets'"});
    expect_words(read("solid x\nendsolid x\n"), {"no faces"});
}

TEST(AsciiStlReader, MutatedFilesAreReadOrRefused) {
    std::mt19937 random(13);
    const std::string good = "solid x\n" + facet("0") + facet("1e5") + "endsolid x\n";
    constexpr char kBytes[] = "0123456789-+. \n\rvertxfacndsoliEN\0\xff";
    const test::TempDir dir;
    for (int round = 0; round < 1500; ++round) {
        std::string text = good;
        for (std::size_t n = 1 + random() % 3; n > 0; --n) {
            text[random() % text.size()] = kBytes[random() % sizeof kBytes];
        }
        if (random() % 4 == 0) text.resize(1 + random() % text.size());
        const auto path = dir.write("x", text);
        const TextResult whole = tests::read_file(open_ascii_stl, path, {.n_threads = 1});
        EXPECT_LE(whole.back.soup.size(), 3U);
        SCOPED_TRACE(text);
        tests::expect_same(
            tests::read_file(open_ascii_stl, path, {.n_threads = 2}, 1 + random() % text.size()),
            whole);
        if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace hewer
