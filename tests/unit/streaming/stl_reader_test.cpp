// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using Soup = std::vector<std::array<Vec3, 3>>;

Soup make_soup(std::size_t n) {
    Soup soup;
    for (std::size_t i = 0; i < n; ++i) {
        const double x = static_cast<double>(i);
        soup.push_back({{{x, 0, 0.5}, {x + 1, 0.25, 0}, {x, 1, -2}}});
    }
    return soup;
}

TEST(StlReader, ReadsASoupOnAnyNumberOfThreads) {
    const test::TempDir dir;
    const Soup soup = make_soup(50000);
    const auto path = dir.write("soup.bin", test::stl_file(soup, 50000));
    const auto source = open_mesh(path);
    EXPECT_FALSE(source->info().is_indexed);
    EXPECT_EQ(source->info().n_vertices, 0U);
    EXPECT_EQ(source->info().n_faces, 50000U);
    EXPECT_TRUE(source->info().ignored.empty());
    for (const unsigned n_threads : {1U, 4U}) {
        const test::ReadBack back = test::read_all(*source, n_threads);
        EXPECT_EQ(back.soup, soup);
        EXPECT_TRUE(back.mesh.positions.empty());
        EXPECT_EQ(back.n_faces, 50000U);
    }
}

TEST(StlReader, IsRecognisedBySizeEvenIfItSaysSolid) {
    const test::TempDir dir;
    const Soup soup = make_soup(3);
    const auto source = open_mesh(dir.write("x", test::stl_file(soup, 3, "solid of a CAD system")));
    EXPECT_EQ(test::read_all(*source).soup, soup);
}

TEST(StlReader, TakesTheCountFromTheSizeIfTheHeaderIsWrong) {
    const test::TempDir dir;
    const Soup soup = make_soup(3);
    for (const std::uint32_t announced : {0U, 2U, 4000000000U}) {
        const auto source = open_mesh(dir.write("x.STL", test::stl_file(soup, announced)));
        EXPECT_EQ(source->info().n_faces, 3U);
        ASSERT_EQ(source->info().ignored.size(), 1U);
        EXPECT_NE(source->info().ignored[0].find(std::to_string(announced)), std::string::npos);
        EXPECT_EQ(test::read_all(*source).soup, soup);
    }
}

TEST(StlReader, RefusesTruncatedAndEmptyFiles) {
    const test::TempDir dir;
    const std::string good = test::stl_file(make_soup(3), 3);
    const auto message = [&](const std::string& content) -> std::string {
        try {
            (void)open_mesh(dir.write("x.stl", content));
        } catch (const FormatError& e) {
            return e.what();
        }
        return "was read";
    };
    const std::string text = message(good.substr(0, 200));
    for (const char* word :
         {"x.stl", "truncated", "3 triangles", "234", "byte 200", "triangle 2"}) {
        EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
    }
    EXPECT_NE(message(test::stl_file({}, 0)).find("no faces"), std::string::npos);
    EXPECT_NE(message(good.substr(0, 50)).find("x.stl"), std::string::npos);
}

TEST(StlReader, NamesWhatStandsBehindItsTriangles) {
    const test::TempDir dir;
    const std::string file = test::stl_file(make_soup(3), 3) + "footer of a program";
    const auto source = open_mesh(dir.write("x.stl", file));
    EXPECT_EQ(source->info().n_faces, 3U);
    ASSERT_EQ(source->info().ignored.size(), 1U);
    EXPECT_EQ(source->info().ignored[0], "the 19 bytes behind the triangles");
}

TEST(StlReader, DropsAndCountsNonFiniteTriangles) {
    const test::TempDir dir;
    Soup soup = make_soup(5);
    soup[1][2][0] = std::numeric_limits<double>::quiet_NaN();
    soup[3][0][1] = std::numeric_limits<double>::infinity();
    const auto path = dir.write("x.stl", test::stl_file(soup, 5));
    const test::ReadBack back = test::read_all(*open_mesh(path));
    EXPECT_EQ(back.soup, (Soup{soup[0], soup[2], soup[4]}));
    EXPECT_EQ(back.defects.nonfinite_triangles, 2U);
    EXPECT_EQ(back.defects.first_nonfinite, "triangle 1 (byte 134)");
    const auto strict = open_mesh(path, {.strict = true});
    EXPECT_THROW((void)test::read_all(*strict), FormatError);
}

TEST(StlReader, SizesBeyondFourGiBAreNotCutShort) {
    const test::TempDir dir;
    const std::uint64_t n = 100'000'000;
    const auto path = dir.write("x.stl", test::stl_file({}, static_cast<std::uint32_t>(n)));
    std::error_code error;
    std::filesystem::resize_file(path, 84 + 50 * n, error);
    if (error) GTEST_SKIP() << "no sparse files here: " << error.message();
    EXPECT_EQ(open_mesh(path)->info().n_faces, n);
    std::filesystem::resize_file(path, 84 + 50 * n - 20);
    EXPECT_THROW((void)open_mesh(path), FormatError);
}

}  // namespace
}  // namespace hewer
