// SPDX-License-Identifier: MIT
#include "streaming/off_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/unit/streaming/text_reading.h"

namespace hewer {
namespace {

using streaming::open_off;
using tests::expect_words;
using tests::TextResult;
using Ids = std::vector<Triangle>;
using Names = std::vector<std::string>;

TextResult read(const std::string& text, bool is_strict = false) {
    return tests::read_in_all_ways(open_off, text, {.strict = is_strict});
}

const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kFaces = "3 0 1 2\n3 0 2 3\n";

TEST(OffReader, ReadsVerticesAndTriangles) {
    const TextResult result = read("OFF\n4 2 5\n" + kSquare + kFaces);
    EXPECT_EQ(result.error, "");
    EXPECT_EQ(result.back.mesh.positions,
              (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(result.info.is_indexed);
    EXPECT_FALSE(result.info.has_normals || result.info.has_colors);
    EXPECT_TRUE(result.info.ignored.empty());
    EXPECT_EQ(result.info.format, "OFF");
}

TEST(OffReader, TakesCountsCommentsAndLineEndsWhereverTheyStand) {
    const Ids expected{{0, 1, 2}, {0, 2, 3}};
    const std::string body = kSquare + kFaces;
    const std::string with_comments =
        "# c\n\n0 0 0 # origin\n 1 0 0\n#\n\t1 1 0\n\n0 1 0\n# faces\n3 0 1 2 #\n\n3  0 2 3\n# end";
    for (const std::string& text :
         {"OFF 4 2 5\n" + body, "OFF4 2 5\n" + body, "OFF\n4 2\n" + body,
          "OFF # x\n\n4\n2\n" + body, "# made by\n# somebody\n\nOFF\n# counts\n4 2 0\n" + body,
          "OFF\n4 2 0\n" + with_comments, "\xEF\xBB\xBFOFF\n4 2 0\n" + body,
          "OFF\n4 2 0\n" + body.substr(0, body.size() - 1)}) {
        for (const std::string end : {"\n", "\r\n", "\r"}) {
            std::string converted;
            for (const char c : text) converted += c == '\n' ? end : std::string(1, c);
            const TextResult result = read(converted);
            EXPECT_EQ(result.error, "") << converted;
            EXPECT_EQ(result.back.mesh.triangles, expected) << converted;
            EXPECT_TRUE(result.info.ignored.empty()) << converted;
            const test::TempDir dir;
            EXPECT_EQ(open_mesh(dir.write("x", converted))->info().format, "OFF") << converted;
        }
    }
}

TEST(OffReader, CarriesColoursOfVertices) {
    const std::string faces = "3 0 1 2\n";
    const TextResult bytes =
        read("COFF\n3 1 0\n0 0 0 0 1 0 255\n1 0 0 255 128 2 255\n0 1 0 1 1 1 0\n" + faces);
    EXPECT_EQ(bytes.back.mesh.colors,
              (std::vector<Rgba16>{
                  {0, 257, 0, 65535}, {65535, 128 * 257, 514, 65535}, {257, 257, 257, 0}}));
    EXPECT_TRUE(bytes.info.has_alpha);
    const TextResult floats =
        read("COFF\n3 1 0\n0 0 0 0 0.5 1\n1 0 0 1 1 1\n0 1 0 0.2 0 0\n" + faces);
    EXPECT_EQ(floats.back.mesh.colors,
              (std::vector<Rgba16>{
                  {0, 32768, 65535, 65535}, {65535, 65535, 65535, 65535}, {13107, 0, 0, 65535}}));
    EXPECT_FALSE(floats.info.has_alpha);
    const TextResult indices = read("COFF\n3 1 0\n0 0 0 7\n1 0 0 8\n0 1 0 9\n" + faces);
    EXPECT_FALSE(indices.info.has_colors);
    EXPECT_EQ(indices.info.ignored, Names{"numbers behind the position of a vertex"});
}

TEST(OffReader, CarriesNormalsAndNamesTextureCoordinates) {
    const std::vector<std::array<float, 3>> normals{{0, 0, 1}, {0, 1, 0}, {0, 0, 0}};
    const std::vector<Rgba16> colors{
        {65535, 0, 0, 65535}, {0, 65535, 0, 65535}, {0, 0, 65535, 65535}};
    const std::string face = "3 0 1 2\n";
    const TextResult n = read("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 1 0\n0 1 0 nan 0 1\n" + face);
    EXPECT_EQ(n.back.mesh.normals, normals);
    const TextResult cn = read(
        "CNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0\n1 0 0 0 1 0 0 255 0\n0 1 0 0 0 0 0 0 255\n" + face);
    EXPECT_EQ(cn.back.mesh.normals, normals);
    EXPECT_EQ(cn.back.mesh.colors, colors);
    // As MeshLab writes it.
    const TextResult nc = read(
        "NCOFF\n3 1 0\n0 0 0 255 0 0 255 0 0 1 \n1 0 0 0 255 0 255 0 1 0 \n"
        "0 1 0 0 0 255 255 0 0 0 \n" +
        face);
    EXPECT_EQ(nc.back.mesh.normals, normals);
    EXPECT_EQ(nc.back.mesh.colors, colors);
    const TextResult st = read("STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n" + face);
    EXPECT_EQ(st.info.ignored, Names{"texture coordinates"});
    const TextResult all = read(
        "STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 0 0\n1 0 0 0 1 0 0 255 0 1 0\n"
        "0 1 0 0 0 0 0 0 255 0 1\n" +
        face);
    EXPECT_EQ(all.back.mesh.normals, normals);
    EXPECT_EQ(all.back.mesh.colors, colors);
}

TEST(OffReader, CutsPolygonsAndNamesColoursOfFaces) {
    const std::string dart = "OFF\n4 3 0\n0 0 0\n1 -1 0\n0 2 0\n-1 -1 0\n";
    const TextResult result = read(dart + "4 1 2 3 0 255 0 0\n3 0 1 2 0.1 0.2 0.3 1\n1 0\n");
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{2, 3, 0}, {2, 0, 1}, {0, 1, 2}}));
    EXPECT_EQ(result.back.defects.polygons, 1U);
    EXPECT_EQ(result.back.defects.short_faces, 1U);
    EXPECT_EQ(result.info.ignored, Names{"colours of faces"});
}

TEST(OffReader, CountsDefectsAndNamesTheFirstPlace) {
    const std::string text = "OFF\n5 6 0\n" + kSquare +
                             "nan 0 1e999\n2 0 1\n0\n3 0 1 2\n3 0 1 5\n3 -1 0 1\n4 0 1 2 99\n";
    const TextResult result = read(text);
    EXPECT_EQ(result.error, "");
    const InputDefects& d = result.back.defects;
    EXPECT_EQ(d.nonfinite_vertices, 1U);
    EXPECT_EQ(d.first_nonfinite, "vertex 4 (line 7)");
    EXPECT_EQ(d.short_faces, 2U);
    EXPECT_EQ(d.out_of_range_triangles, 3U);
    EXPECT_EQ(d.first_out_of_range, "face 3 (line 11)");
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 1, 2}}));
    expect_words(read(text, true), {"vertex 4 (line 7)", "strict"});
    expect_words(read("OFF\n4 2 0\n" + kSquare + "3 0 1 4\n2 0 1\n", true),
                 {"face 0 (line 7)", "4 vertices", "strict"});
    expect_words(read("OFF\n4 2 0\n" + kSquare + "2 0 1\n3 0 1 4\n", true),
                 {"face 0 (line 7)", "fewer than three", "strict"});
}

TEST(OffReader, FewerLinesThanAnnouncedAreATruncatedFile) {
    expect_words(read("OFF\n6 2 0\n" + kSquare), {"truncated", "4 of the 6 vertices"});
    expect_words(read("OFF\n4 3 0\n" + kSquare + kFaces), {"truncated", "2 of the 3 faces"});
    expect_words(read("OFF\n4 2 0\n" + kSquare), {"truncated", "0 of the 2 faces"});
    expect_words(read("OFF\n4 2 0\n" + kSquare + "3 0 1 2\n3 0 2\n"), {"line 8", "the line ends"});
    // Counts are not believed, whatever they are.
    for (const char* count : {"9223372036854775807", "999999999999999999", "4294967300"}) {
        const std::string n = count;
        EXPECT_FALSE(read("OFF\n" + n + " 2 0\n" + kSquare + kFaces).error.empty());
        EXPECT_FALSE(read("OFF\n4 " + n + " 0\n" + kSquare + kFaces).error.empty());
        EXPECT_FALSE(read("OFF\n4 2 0\n" + kSquare + n + " 0 1 2\n3 0 1 2\n").error.empty());
    }
}

TEST(OffReader, LinesAfterTheLastFaceAreNamed) {
    for (const char* rest : {"3 0 1 2\n", "2 0 1\n3 7 8 9\n", "here be edges\n"}) {
        const TextResult result = read("OFF\n4 2 0\n" + kSquare + kFaces + rest);
        EXPECT_EQ(result.error, "") << rest;
        EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 2, 3}}));
        EXPECT_EQ(result.back.defects.short_faces, 0U);
        EXPECT_EQ(result.info.ignored, Names{"lines after the last face"}) << rest;
    }
}

TEST(OffReader, SaysWhatItCannotReadAndWhere) {
    expect_words(read("OFF BINARY\n4 2 0\n"), {"line 1", "binary OFF", "PLY"});
    expect_words(read("4OFF\n1 1 0\n0 0 0 1\n"), {"line 1", "'4OFF'", "three dimensions"});
    expect_words(read("nOFF\n3\n1 1 0\n"), {"line 1", "'nOFF'", "three dimensions"});
    expect_words(read("XOFF\n4 2 0\n" + kSquare), {"line 1", "'XOFF'"});
    expect_words(read("4 2 0\n" + kSquare), {"line 1", "'4'", "'OFF'"});
    expect_words(read("# x\nOFF\nfour 2 0\n"), {"line 3", "'four'", "number of vertices"});
    expect_words(read("OFF\n-4 2 0\n"), {"line 2", "'-4'"});
    expect_words(read("OFF\n4 x 0\n"), {"line 2", "'x'", "number of faces"});
    expect_words(read("OFF\n"), {"number of vertices"});
    expect_words(read("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), {"line 4", "the line ends"});
    expect_words(read("OFF\n3 1 0\n0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n"), {"line 4", "'x'"});
    expect_words(read("NOFF\n3 1 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n"), {"line 3", "line ends"});
    expect_words(read("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 x\n"), {"line 6", "'x'", "id"});
    expect_words(read("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\nthree 0 1 2\n"), {"line 6", "'three'"});
    expect_words(read("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), {"no faces", "point cloud"});
    const test::TempDir dir;
    try {
        (void)open_mesh(dir.write("x", "OFFSET 3\n1 2 3\n"));
        ADD_FAILURE() << "was taken for OFF";
    } catch (const FormatError& e) {
        EXPECT_NE(std::string(e.what()).find("unknown to hewer"), std::string::npos) << e.what();
    }
    EXPECT_THROW((void)open_mesh(dir.write("x", std::string("OFF BINARY\n\0\0\0\1\xff", 16))),
                 FormatError);
}

TEST(OffReader, MutatedFilesAreReadOrRefused) {
    std::mt19937 random(17);
    const std::string good =
        "COFF\n# x\n4 3 0\n0 0 0 1 0 0\n1 0 0 255 0 0 7\n1 1 0\n0 1 0\n"
        "3 0 1 2\n4 0 1 2 3 9 9 9\n5 0 1 2 3 3\n";
    constexpr char kBytes[] = "0123456789-+. \n\r#OFCN\0\xff";
    const test::TempDir dir;
    for (int round = 0; round < 1500; ++round) {
        std::string text = good;
        for (std::size_t n = 1 + random() % 3; n > 0; --n) {
            text[random() % text.size()] = kBytes[random() % sizeof kBytes];
        }
        if (random() % 4 == 0) text.resize(1 + random() % text.size());
        const auto path = dir.write("x", text);
        const TextResult whole = tests::read_file(open_off, path, {.n_threads = 1});
        for (const Triangle& t : whole.back.mesh.triangles) {
            EXPECT_LT(std::max({t[0], t[1], t[2]}), whole.back.mesh.positions.size());
        }
        SCOPED_TRACE(text);
        tests::expect_same(
            tests::read_file(open_off, path, {.n_threads = 2}, 1 + random() % text.size()), whole);
        if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace hewer
