// SPDX-License-Identifier: MIT
#include "streaming/obj_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hewer/mesh_sink.h"
#include "tests/unit/streaming/sample_mesh.h"
#include "tests/unit/streaming/text_reading.h"

namespace hewer {
namespace {

using streaming::open_obj;
using tests::expect_words;
using tests::TextResult;
using Ids = std::vector<Triangle>;
using Names = std::vector<std::string>;

TextResult read(const std::string& text, bool is_strict = false) {
    return tests::read_in_all_ways(open_obj, text, {.strict = is_strict});
}

Mesh mesh_of(const std::string& text) {
    const TextResult result = read(text);
    EXPECT_EQ(result.error, "");
    return result.back.mesh;
}

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, ReadsVerticesAndTriangles) {
    const TextResult result = read(kSquare + "f 1 2 3\nf 1 3 4\n");
    EXPECT_EQ(result.back.mesh.positions,
              (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(result.info.is_indexed);
    EXPECT_FALSE(result.info.has_normals || result.info.has_colors);
    EXPECT_TRUE(result.info.ignored.empty());
    EXPECT_EQ(result.info.format, "OBJ");
}

TEST(ObjReader, TakesAnyKindOfLineAndBlank) {
    const Ids expected{{0, 1, 2}};
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        for (const bool has_last_end : {true, false}) {
            const std::string text = "# a comment" + end + end + " \tv 0 0 0" + end +
                                     "v\t1\t0\t0 " + end + "v  0 +1 0\t" + end + "# f 9 9 9" + end +
                                     "f  1\t2 3" + (has_last_end ? end : "");
            EXPECT_EQ(mesh_of(text).triangles, expected) << text;
        }
    }
    EXPECT_EQ(mesh_of("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").triangles, expected);
    EXPECT_EQ(mesh_of("v 0 0 0 # first\nv 1 0 0\nv 0 1 0\nf 1 2 3 # only\n").triangles, expected);
}

TEST(ObjReader, JoinsLinesThatABackslashContinues) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const std::string text = "v 0 0 \\" + end + "0" + end + "v 1 0 0" + end + "v 0 1 0" + end +
                                 "f 1 \\" + end + "2\\" + end + " 3" + end + "f 1 2 x" + end;
        const std::string start = text.substr(0, text.find("f 1 2 x"));
        EXPECT_EQ(mesh_of(start).triangles, (Ids{{0, 1, 2}})) << text;
        // Lines are counted as they stand in the file.
        expect_words(read(text), {"line 8", "'x'"});
    }
    // A comment ends where it ends.
    EXPECT_EQ(mesh_of("# C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").positions.size(), 3U);
}

TEST(ObjReader, KnowsNegativeIdsAndAllKindsOfCorners) {
    const Ids expected{{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(mesh_of(kSquare + "f -4 -3 -2\nf -4 -2 -1\n").triangles, expected);
    EXPECT_EQ(mesh_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -4 -2 4\n").triangles,
              expected);
    const std::string rest = "vt 0 0\nvn 0 0 1\n";
    EXPECT_EQ(mesh_of(kSquare + rest + "f 1/1 2/1 3/1\nf 1/ 3/ 4/\n").triangles, expected);
    EXPECT_EQ(mesh_of(kSquare + rest + "f 1//1 2//1 3//1\nf 1// 3// 4//\n").triangles, expected);
    EXPECT_EQ(mesh_of(kSquare + rest + "f 1/1/1 2/1/1 3/1/1\nf 1/-1/-1 3/1/ 4/1/1\n").triangles,
              expected);
    // Faces may come first.
    EXPECT_EQ(mesh_of("f 1 2 3\nf 1 3 4\n" + kSquare).triangles, expected);
}

TEST(ObjReader, NamesWhatItDoesNotCarry) {
    const TextResult result =
        read("mtllib a b.mtl\no thing\ng part one\ns 1\nusemtl red\n" + kSquare +
             "vt 0 0\nvt 1 0\nvt 1 1\nvp 0\nl 1 2\np 1\ncurv 0 1 1 2\nsurprise 17\nv2 1 2 3\n"
             "f 1/1 2/2 3/3\n");
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}}));
    Names ignored = result.info.ignored;
    // Of the two libraries, neither of which is there.
    const auto is_library = [](const std::string& name) { return name.starts_with("materials /"); };
    EXPECT_EQ(std::erase_if(ignored, is_library), 2U);
    EXPECT_EQ(
        ignored,
        (Names{"points of parameter spaces", "lines", "points", "free-form curves and surfaces",
               "lines that are not known to be OBJ, such as those that begin with 'surprise'",
               "materials that no library defines, such as red", "texture coordinates"}));
}

TEST(ObjReader, CarriesNormalsThatGoWithTheirVertices) {
    const std::string normals = "vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nvn nan 0 1\n";
    const std::vector<std::array<float, 3>> expected{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    for (const char* faces :
         {"f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n", "f -4//-4 -3//-3 -2/7/-2 -1//-1\n"}) {
        EXPECT_EQ(mesh_of(kSquare + normals + faces).normals, expected) << faces;
    }
    EXPECT_EQ(mesh_of("v 0 0 0\nvn 0 0 1\nv 1 0 0\nvn 0 1 0\nv 1 1 0\nvn 1 0 0\nf -3//-3 -2//-2 "
                      "-1//-1\nv 0 1 0\nvn inf 0 1\nf 1//1 3//3 4//4\n")
                  .normals,
              expected);
    // Fewer normals than vertices: those at the end are in no face.
    EXPECT_EQ(mesh_of(kSquare + "vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nf 1//1 2//2 3//3\n").normals,
              expected);
}

TEST(ObjReader, DropsNormalsThatBelongToCorners) {
    const std::string normals = "vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nvn 1 0 0\n";
    for (const char* faces :
         {"f 1//2 2//2 3//3\n", "f 1//1 2//2 3//3\nf 1 3 4\n", "f 1 2 3\n",
          "f -4//-4 -3//-3 -2//-1\n", "f 1//-4 2//2 3//3\n", "vn 0 0 1\nf 1//1 2//2 3//3\n",
          "v 2 2 2\nf -4//-4 -3//-3 -2//-2\n"}) {
        const TextResult result = read(kSquare + normals + faces);
        EXPECT_EQ(result.error, "");
        EXPECT_FALSE(result.info.has_normals) << faces;
        EXPECT_EQ(result.info.ignored, Names{"normals that are not one for each vertex"}) << faces;
    }
}

TEST(ObjReader, TellsColoursInBytesFromColoursInFloats) {
    const std::string face = "f 1 2 3\n";
    const Mesh floats = mesh_of("v 0 0 0 0 0.5 1\nv 1 0 0 1 1 1\nv 0 1 0 0.2 0 7e-1\n" + face);
    EXPECT_EQ(floats.colors, (std::vector<Rgba16>{{0, 32768, 65535, 65535},
                                                  {65535, 65535, 65535, 65535},
                                                  {13107, 0, 45875, 65535}}));
    // The first two could be either.
    const Mesh bytes = mesh_of("v 0 0 0 0 1 0\nv 1 0 0 1 1 1\nv 0 1 0 255 128 2\n" + face);
    EXPECT_EQ(bytes.colors,
              (std::vector<Rgba16>{
                  {0, 257, 0, 65535}, {257, 257, 257, 65535}, {65535, 128 * 257, 514, 65535}}));
    const TextResult alpha =
        read("v 0 0 0 0 1 0 1\nv 1 0 0 255 0 0 51\nv 0 1 0 1 2 3 255\n" + face);
    EXPECT_TRUE(alpha.info.has_alpha);
    EXPECT_EQ(
        alpha.back.mesh.colors,
        (std::vector<Rgba16>{{0, 257, 0, 257}, {65535, 0, 0, 51 * 257}, {257, 514, 771, 65535}}));
}

TEST(ObjReader, VerticesWithoutColourAreWhiteBesideColouredOnes) {
    const Mesh mesh = mesh_of("v 0 0 0\nv 1 0 0 2 4 6\nv 0 1 0\nf 1 2 3\n");
    constexpr Rgba16 kWhite{65535, 65535, 65535, 65535};
    EXPECT_EQ(mesh.colors, (std::vector<Rgba16>{kWhite, {514, 1028, 1542, 65535}, kWhite}));
}

TEST(ObjReader, LeavesOutWeights) {
    const TextResult ones = read("v 0 0 0 1\nv 1 0 0 1.0\nv 0 1 0 1\nf 1 2 3\n");
    EXPECT_FALSE(ones.info.has_colors);
    EXPECT_TRUE(ones.info.ignored.empty());
    EXPECT_EQ(ones.back.mesh.positions[1], (Vec3{1, 0, 0}));
    const TextResult weighted = read("v 0 0 0 0.5\nv 1 0 0 1\nv 0 1 0 1 2\nf 1 2 3\n");
    EXPECT_EQ(weighted.info.ignored,
              (Names{"weights of vertices", "numbers behind the position of a vertex"}));
}

TEST(ObjReader, CutsConcavePolygonsWithoutLeavingThem) {
    // A dart: 1 - 3 lies outside.
    EXPECT_EQ(mesh_of("v 0 0 0\nv 1 -1 0\nv 0 2 0\nv -1 -1 0\nf 2 3 4 1\nf 1 2 3 4\n").triangles,
              (Ids{{2, 3, 0}, {2, 0, 1}, {0, 1, 2}, {0, 2, 3}}));
    const TextResult l =
        read("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 3 4 5 6 1 2\nf 1 2 3\n");
    EXPECT_EQ(l.back.defects.polygons, 1U);
    ASSERT_EQ(l.back.mesh.triangles.size(), 5U);
    EXPECT_EQ(l.back.mesh.triangles.back(), (Triangle{0, 1, 2}));
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& p = l.back.mesh.positions;
        const auto& t = l.back.mesh.triangles[i];
        const double twice = (p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) -
                             (p[t[1]][1] - p[t[0]][1]) * (p[t[2]][0] - p[t[0]][0]);
        EXPECT_GE(twice, 0);
        area += twice / 2;
    }
    EXPECT_DOUBLE_EQ(area, 3);
}

TEST(ObjReader, CountsPolygonsThatItHasToFan) {
    const TextResult early = read("f 2 3 4 1\nv 0 0 0\nv 1 -1 0\nv 0 2 0\nv -1 -1 0\n");
    EXPECT_EQ(early.back.mesh.triangles, (Ids{{1, 2, 3}, {1, 3, 0}}));
    ASSERT_EQ(early.info.ignored.size(), 1U);
    EXPECT_NE(early.info.ignored[0].find("1 polygons"), std::string::npos);

    std::string text = kSquare + "f";
    for (int i = 0; i < 5000; ++i) text += " 1 2 3 4";
    const test::TempDir dir;
    const TextResult large = tests::read_file(open_obj, dir.write("x", text + "\n"));
    EXPECT_EQ(large.back.mesh.triangles.size(), 19998U);
    EXPECT_EQ(large.info.ignored.size(), 1U);
}

TEST(ObjReader, CountsDefectsAndNamesTheFirstPlace) {
    const std::string text = "# 1\n" + kSquare +
                             "v nan 0 0\nv 0 1e999 0\n"
                             "f 1 2\nf 3\nf\n"
                             "f 1 2 3\nf 99\nf 1 0 3\nf 1 2 3 4 7\nf 1 2 -7\nf 1 2 999999999999\n";
    const TextResult result = read(text);
    EXPECT_EQ(result.error, "");
    const InputDefects& d = result.back.defects;
    EXPECT_EQ(d.nonfinite_vertices, 2U);
    EXPECT_EQ(d.first_nonfinite, "vertex 4 (line 6)");
    EXPECT_EQ(d.short_faces, 4U);
    EXPECT_EQ(d.out_of_range_triangles, 4U);
    EXPECT_EQ(d.first_out_of_range, "face 5 (line 13)");
    EXPECT_EQ(d.polygons, 1U);
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(result.back.mesh.positions.size(), 6U);
}

TEST(ObjReader, FindsTheFirstIdThatNoLaterVertexMakesGood) {
    // Ids that point forward are good or not depending on the end of the file.
    const TextResult result = read("f 1 2 3\nf 1 2 5\nf 1 2 4\nf 1 6 4\n" + kSquare + "f 1 2 7\n");
    EXPECT_EQ(result.back.defects.first_out_of_range, "face 1 (line 2)");
    EXPECT_EQ(result.back.defects.out_of_range_triangles, 3U);
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}, {0, 1, 3}}));
}

TEST(ObjReader, StrictRefusesDefects) {
    expect_words(read(kSquare + "v inf 0 0\nf 1 2 3\n", true),
                 {"vertex 4 (line 5)", "not finite", "strict"});
    expect_words(read(kSquare + "f 1 2 3\nf 1 2\n", true),
                 {"face 1 (line 6)", "fewer than three", "strict"});
    expect_words(read(kSquare + "f 1 2 3\nf 1 2 5\n", true),
                 {"face 1 (line 6)", "4 vertices", "strict"});
    // The first of two, wherever the chunks end.
    expect_words(read(kSquare + "f 1 2\nv nan 0 0\nf 1 2 3\n", true), {"face 0 (line 5)"});
    expect_words(read("v nan 0 0\n" + kSquare + "f 1 2\nf 1 2 x\n", true), {"vertex 0 (line 1)"});
    EXPECT_EQ(read(kSquare + "f 1 2 3 4\n", true).error, "");
}

TEST(ObjReader, SaysWhatItCannotReadAndWhere) {
    const auto refused = [](const std::string& line, const std::vector<std::string>& words) {
        const TextResult result = read(kSquare + "f 1 2 3\n" + line + "\nf 1 2 3\n");
        expect_words(result, {"input: line 6: "});
        expect_words(result, words);
    };
    refused("v 1 2", {"the line ends", "a number"});
    refused("v", {"the line ends", "a number"});
    refused("v 1 2 x", {"'x' is not a number"});
    refused("v 1 2 0x10", {"'0x10' is not a number"});
    refused("v 1,5 2 3", {"'1,5' is not a number", "commas"});
    refused("v 1 2 3 4 5 red", {"'red' is not a number"});
    refused("vn 1 2", {"the line ends"});
    refused("f 1 2 3.5", {"'3.5' is not a corner"});
    refused("f 1 2 /3", {"'/3' is not a corner"});
    refused("f 1 2 3/x", {"'3/x' is not a corner"});
    refused("f 1 2 3/1/1/1", {"'3/1/1/1' is not a corner"});
    refused("f 1 2 -", {"'-' is not a corner"});
    refused("f 1 2 1234567890123456789", {"'1234567890123456789'"});
    refused("0.5 0.25 0.125", {"'0.5'", "OBJ"});
    refused(std::string("\x01\x02 1"), {"line 6"});
}

TEST(ObjReader, APointCloudIsNoMesh) {
    expect_words(read(kSquare), {"no faces", "4 vertices", "point cloud"});
    expect_words(read(kSquare + "f 1 2\n"), {"no faces"});
    expect_words(read("# nothing\n"), {"no faces"});
}

TEST(ObjReader, RefusesEndlessLines) {
    const test::TempDir dir;
    const auto path = dir.write("x.obj", kSquare + "f 1 2 3\n# ");
    // A hole of zeros, which are blanks: one line.
    std::error_code error;
    std::filesystem::resize_file(path, 200 << 20, error);
    if (error) GTEST_SKIP() << "no sparse files here: " << error.message();
    expect_words(tests::read_file(open_obj, path), {"line 6", "64.0 MiB"});
    // Half of that is read.
    std::filesystem::resize_file(path, 32 << 20);
    const TextResult result = tests::read_file(open_obj, path, {.n_threads = 2});
    EXPECT_EQ(result.back.mesh.triangles, (Ids{{0, 1, 2}}));
}

TEST(ObjReader, ALongLineNeedsMemoryWithinTheLimit) {
    const test::TempDir dir;
    std::string text = kSquare + "f";
    for (int i = 0; i < 4'000'000; ++i) text += " 1";
    const auto path = dir.write("x.obj", text);
    const ooc::InputFile file(path);
    EXPECT_THROW((void)open_obj(file, {.memory_bytes = 64 << 20, .n_threads = 2}, {}),
                 OutOfMemoryBudget);
}

TEST(ObjReader, KeepsThePrecisionOfMapCoordinates) {
    const Mesh mesh = mesh_of(
        "v 4500000.125 5400000.001 100\nv 4500001 5400000 100\n"
        "v 4500000 5400001 100\nf 1 2 3\n");
    EXPECT_EQ(mesh.positions[0], (Vec3{4500000.125, 5400000.001, 100}));
}

TEST(ObjReader, ReadsBackWhatHewerWrites) {
    for (const bool has_normals : {true, false}) {
        const test::TempDir dir;
        Mesh mesh = tests::wavy_sheet(40, 10, {1, 2, 3});
        if (!has_normals) mesh.normals.clear();
        for (Vec3& p : mesh.positions) {
            for (double& x : p) x = static_cast<double>(static_cast<float>(x));
        }
        const auto path = dir.path() / "a.obj";
        tests::pour(mesh, *create_mesh_file(path));
        for (const unsigned n_threads : {1U, 4U}) {
            const TextResult back =
                tests::read_file(open_obj, path, {.n_threads = n_threads}, 1000);
            EXPECT_EQ(back.error, "");
            EXPECT_EQ(back.back.mesh.positions, mesh.positions);
            EXPECT_EQ(back.back.mesh.normals, mesh.normals);
            EXPECT_EQ(back.back.mesh.triangles, mesh.triangles);
            ASSERT_EQ(back.back.mesh.colors.size(), mesh.colors.size());
            for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {  // five digits of 65535 steps
                    EXPECT_NEAR(back.back.mesh.colors[i][k], mesh.colors[i][k], 1);
                }
            }
            EXPECT_TRUE(back.info.ignored.empty());
        }
    }
}

TEST(ObjReader, StopsWhenAskedTo) {
    const test::TempDir dir;
    std::string text = kSquare;
    for (int i = 0; i < 100'000; ++i) text += "f 1 2 3\n";
    const ooc::InputFile file(dir.write("x.obj", text));
    const test::TempDir temp;
    for (const unsigned n_threads : {1U, 4U}) {
        std::stop_source stop;
        Hooks hooks;
        hooks.stop = stop.get_token();
        hooks.on_progress = [&](const Progress& progress) {
            EXPECT_EQ(progress.unit, "bytes");
            stop.request_stop();
        };
        EXPECT_THROW((void)open_obj(file, {.n_threads = n_threads, .temp_dir = temp.path()}, hooks,
                                    {.chunk_bytes = 1000}),
                     Cancelled);
        EXPECT_EQ(temp.n_entries(), 0U);
    }
}

TEST(ObjReader, TemporaryDiskIsLimited) {
    const test::TempDir dir;
    std::string text = kSquare;
    for (int i = 0; i < 100'000; ++i) text += "f 1 2 3\n";
    const ooc::InputFile file(dir.write("x.obj", text));
    EXPECT_THROW((void)open_obj(file, {.max_temp_bytes = 1 << 20}, {}), OutOfDiskBudget);
    EXPECT_NO_THROW((void)open_obj(file, {.max_temp_bytes = 2 << 20}, {}));
}

TEST(ObjReader, IsRecognisedByItsContent) {
    const test::TempDir dir;
    const std::string text = kSquare + "f 1 2 3\n";
    std::string crs = text;
    std::replace(crs.begin(), crs.end(), '\n', '\r');
    for (const std::string& content :
         {text, crs, "\xEF\xBB\xBF" + text, std::string(20000, '#') + "\n" + text,
          std::string("v 0 0 \\\n0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")}) {
        EXPECT_EQ(open_mesh(dir.write("x", content))->info().format, "OBJ");
    }
}

TEST(ObjReader, MutatedFilesAreReadOrRefused) {
    std::mt19937 random(11);
    const std::string good = "# x\nmtllib a\n" + kSquare + "vn 0 0 1\nvt 0 0\nv 2 2 2 1 0.5 0\n" +
                             "f 1/1/1 2/1/1 3/1/1\nf -1//-1 1 2 3 4\nf 1 \\\n2 4\nl 1 2\n";
    constexpr char kBytes[] = "0123456789-+./\\ \n\r\tvfnt#e\0\xff";
    const test::TempDir dir;
    for (int round = 0; round < 1500; ++round) {
        std::string text = good;
        for (std::size_t n = 1 + random() % 5; n > 0; --n) {
            text[random() % text.size()] = kBytes[random() % sizeof kBytes];
        }
        if (random() % 4 == 0) text.resize(1 + random() % text.size());
        const auto path = dir.write("x", text);
        const TextResult whole = tests::read_file(open_obj, path, {.n_threads = 1});
        for (const Triangle& t : whole.back.mesh.triangles) {
            EXPECT_LT(std::max({t[0], t[1], t[2]}), whole.back.mesh.positions.size());
        }
        SCOPED_TRACE(text);
        tests::expect_same(
            tests::read_file(open_obj, path, {.n_threads = 2}, 1 + random() % text.size()), whole);
        if (HasFailure()) return;
    }
}

}  // namespace
}  // namespace hewer
