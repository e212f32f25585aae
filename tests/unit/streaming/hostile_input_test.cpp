// SPDX-License-Identifier: MIT
/// Files that are broken, dirty or no meshes get one clear message, or are read as far as promised.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/packed.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using test::PlyMesh;
using test::PlyStyle;
using test::ReadBack;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PlyMesh tetrahedron() {
    PlyMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

PlyStyle in_format(const std::string& format) {
    PlyStyle style;
    style.format = format;
    return style;
}

std::string replace(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

class HostileInput : public ::testing::Test {
  protected:
    /// Opens and reads the file; a FormatError is expected that names the path and all `words`.
    void expect_refused(const std::string& content, const std::vector<std::string>& words,
                        bool is_strict = false, const std::string& name = "input.bin") {
        const std::filesystem::path path = dir_.write(name, content);
        try {
            const auto source = open_mesh(path, {.strict = is_strict});
            // One thread: which of two defects is met first is up to the threads otherwise.
            (void)test::read_all(*source, 1);
            ADD_FAILURE() << "was read; expected: " << words.front();
        } catch (const FormatError& e) {
            const std::string text = e.what();
            EXPECT_NE(text.find(path.string()), std::string::npos) << text;
            for (const std::string& word : words) {
                EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
            }
        }
    }
    ReadBack read(const std::string& content) {
        return test::read_all(*open_mesh(dir_.write("input.bin", content)));
    }
    test::TempDir dir_;
};

TEST_F(HostileInput, HeaderMistakesNameTheirLine) {
    const std::string good = test::ply_file(tetrahedron());
    expect_refused(replace(good, "property float y", "property real y"), {"line 5", "real"});
    expect_refused(replace(good, "element vertex 4", "element vertex -4"), {"line 3", "negative"});
    expect_refused(replace(good, "element vertex 4", "element vertex 99999999999999999999"),
                   {"line 3", "99999999999999999999"});
    expect_refused(replace(good, "element vertex 4", "element vertex four"), {"line 3", "four"});
    expect_refused(replace(good, "list uchar int", "list float int"), {"line 8", "float"});
    expect_refused(replace(good, "list uchar int", "list uchar float"), {"vertex ids"});
    expect_refused(replace(good, "property float x", "propertie float x"), {"line 4", "propertie"});
    expect_refused(replace(good, "property float x", "property float"), {"line 4"});
    expect_refused(replace(good, "binary_little_endian", "binary_middle_endian"),
                   {"line 2", "binary_middle_endian"});
    expect_refused(replace(good, "format binary_little_endian 1.0\n", ""), {"format"});
    expect_refused(replace(good, "element vertex 4\n", ""), {"line 3", "before any element"});
    expect_refused(replace(good, "element face", "element vertex"), {"second element"});
    expect_refused(replace(good, "property float y", "property float q"), {"x, y and z"});
    expect_refused(replace(good, "vertex_indices", "corners"), {"vertex_indices"});
    expect_refused(replace(good, "element vertex", "element point"), {"no vertex element"});
    expect_refused("ply\n", {"end_header"});
    expect_refused(good.substr(0, 60), {"end_header"});
    expect_refused("ply\ncomment " + std::string(2 << 20, 'x'), {"end_header"});
}

TEST_F(HostileInput, CountsBeyondTheFileAreRefusedBeforeAnyAllocation) {
    for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
        SCOPED_TRACE(format);
        const std::string good = test::ply_file(tetrahedron(), in_format(format));
        for (const char* count : {"1152921504606846976", "18446744073709551615", "5000"}) {
            expect_refused(replace(good, "vertex 4", std::string("vertex ") + count),
                           {"truncated", "vertex", "byte"});
            expect_refused(replace(good, "face 4", std::string("face ") + count),
                           {"truncated", "face", "byte"});
        }
    }
}

TEST_F(HostileInput, EmptyElementsAreNoMesh) {
    for (const char* format : {"binary_little_endian", "ascii"}) {
        PlyMesh mesh = tetrahedron();
        const std::string good = test::ply_file(mesh, in_format(format));
        expect_refused(replace(good, "vertex 4", "vertex 0"), {"no vertices"});
        expect_refused(replace(good, "face 4", "face 0"), {"no faces"});
        PlyStyle strips = in_format(format);
        strips.has_strips = true;
        mesh.faces = {{1, 1, 1, 1}};
        expect_refused(test::ply_file(mesh, strips), {"no faces"});
    }
}

TEST_F(HostileInput, ElementsWithoutPropertiesCostNothing) {
    const std::string good = test::ply_file(tetrahedron());
    const ReadBack back = read(
        replace(good, "element vertex", "element nothing 18446744073709551615\nelement vertex"));
    EXPECT_EQ(back.mesh.triangles.size(), 4U);
}

TEST_F(HostileInput, TruncationNamesElementAndPlace) {
    const std::string binary = test::ply_file(tetrahedron());
    const std::size_t body = binary.size() - 4 * 12 - 4 * 13;
    expect_refused(binary.substr(0, body + 30), {"truncated", "vertex", "row 2"});
    expect_refused(binary.substr(0, body + 48 + 20),
                   {"truncated", "face 1", "byte " + std::to_string(body + 48 + 13)});
    PlyStyle style;
    style.has_extra_lists = true;
    const std::string lists = test::ply_file(tetrahedron(), style);
    expect_refused(lists.substr(0, lists.size() - 3), {"truncated", "face 3", "byte"});
    const std::string ascii = test::ply_file(tetrahedron(), in_format("ascii"));
    expect_refused(ascii.substr(0, ascii.size() - 5), {"truncated", "face 3", "line 17"});
}

TEST_F(HostileInput, ListCountsAreNotBelieved) {
    PlyStyle style;
    style.count_type = "int";
    const std::string good = test::ply_file(tetrahedron(), style);
    const std::size_t third = good.size() - 2 * 16;
    const auto with_count = [&](double count) {
        std::string text = good;
        return text.replace(third, 4, test::ply_value(style.format, "int", count));
    };
    expect_refused(with_count(-3), {"face 2", "negative", "-3", "byte " + std::to_string(third)});
    expect_refused(with_count(2147483647), {"face 2", "2147483647", "left"});

    style.format = "ascii";
    const std::string ascii = test::ply_file(tetrahedron(), style);
    expect_refused(replace(ascii, "3 0 3 2", "-3 0 3 2"), {"face 2", "line 16", "negative"});
    expect_refused(replace(ascii, "3 0 3 2", "2147483647 0 3 2"), {"face 2", "line 16"});
    expect_refused(replace(ascii, "3 0 3 2", "3.5 0 3 2"), {"face 2", "line 16", "3.5"});
    expect_refused(replace(ascii, "3 0 3 2", "3 0 x 2"), {"face 2", "line 16", "'x'"});
    expect_refused(replace(ascii, "3 0 3 2", "3 0 99999999999999999999 2"), {"face 2", "line 16"});
}

TEST_F(HostileInput, RowsTooLargeForABatchAreRefused) {
    PlyMesh mesh = tetrahedron();
    mesh.faces[1].assign(1'500'000, 2);
    PlyStyle style;
    style.count_type = "uint";
    expect_refused(test::ply_file(mesh, style), {"face 1", "4.00 MiB", "byte"});
    style.format = "ascii";
    mesh.faces[1].assign(2'500'000, 2);
    expect_refused(test::ply_file(mesh, style), {"face 1", "4.00 MiB", "line 15"});
}

TEST_F(HostileInput, ListCountsOfSkippedElementsAreNotBelieved) {
    PlyStyle style;
    style.has_extra_elements = true;
    std::string text = test::ply_file(tetrahedron(), style);
    const std::size_t count = text.find("end_header\n") + 11 + 8;
    EXPECT_EQ(text[count], '\1');
    text[count] = '\xff';  // camera 0 now ends within the vertices, or beyond the file
    expect_refused(text, {"camera 0", "byte"});
}

TEST_F(HostileInput, WordsThatAreNoNumbersNameTheirLine) {
    const std::string good = test::ply_file(tetrahedron(), in_format("ascii"));
    expect_refused(replace(good, "0 1 0", "0 1,5 0"), {"line 12", "vertex 2", "1,5"});
    expect_refused(replace(good, "0 1 0", "0 - 0"), {"line 12", "vertex 2"});
    expect_refused(replace(good, "0 1 0", "0 1e 0"), {"line 12", "vertex 2"});
    expect_refused(replace(good, "0 1 0", "0 0x1 0"), {"line 12", "vertex 2"});
}

TEST_F(HostileInput, NonFiniteCoordinatesAreCountedAndPassedOn) {
    for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
        for (const char* type : {"float", "double"}) {
            SCOPED_TRACE(std::string(format) + " " + type);
            PlyMesh mesh = tetrahedron();
            mesh.positions[2][1] = kNan;
            mesh.positions[3][0] = -kInfinity;
            PlyStyle style = in_format(format);
            style.coordinate_type = type;
            const std::string text = test::ply_file(mesh, style);
            const ReadBack back = read(text);
            EXPECT_EQ(back.defects.nonfinite_vertices, 2U);
            ASSERT_EQ(back.mesh.positions.size(), 4U);
            EXPECT_TRUE(std::isnan(back.mesh.positions[2][1]));
            EXPECT_EQ(back.mesh.positions[3][0], -kInfinity);
            EXPECT_EQ(back.mesh.triangles.size(), 4U);
            const std::size_t body = text.find("end_header\n") + 11;
            const std::string place =
                style.format == "ascii"
                    ? "vertex 2 (line 12)"
                    : "vertex 2 (byte " +
                          std::to_string(body + 2 * (style.coordinate_type == "float" ? 12 : 24)) +
                          ")";
            EXPECT_EQ(back.defects.first_nonfinite, place);
            expect_refused(text, {place, "not finite"}, true);
        }
    }
}

TEST_F(HostileInput, MicrosoftsSpellingsOfNanAreUnderstood) {
    const std::string good = test::ply_file(tetrahedron(), in_format("ascii"));
    const ReadBack back = read(replace(good, "0 1 0", "1.#QNAN -1.#IND 1e999"));
    EXPECT_EQ(back.defects.nonfinite_vertices, 1U);
    EXPECT_EQ(back.mesh.positions[2][2], kInfinity);
}

TEST_F(HostileInput, IdsOutOfRangeDropTheirTrianglesOnly) {
    for (const char* format : {"binary_little_endian", "binary_big_endian", "ascii"}) {
        for (const bool has_polygon : {false, true}) {
            SCOPED_TRACE(format);
            PlyMesh mesh = tetrahedron();
            mesh.faces[1] = {0, 1, 4};
            mesh.faces[2] = {0, -1, 3};
            if (has_polygon) mesh.faces.push_back({0, 1, 2, 2000000000});
            const std::string text = test::ply_file(mesh, in_format(format));
            const ReadBack back = read(text);
            EXPECT_EQ(back.defects.out_of_range_triangles, has_polygon ? 3U : 2U);
            std::vector<Triangle> expected{{0, 2, 1}, {1, 2, 3}};
            if (has_polygon) expected.push_back({0, 1, 2});
            EXPECT_EQ(back.mesh.triangles, expected);
            const std::size_t body = text.find("end_header\n") + 11;
            const std::string place = std::string(format) == "ascii"
                                          ? "face 1 (line 15)"
                                          : "face 1 (byte " + std::to_string(body + 48 + 13) + ")";
            EXPECT_EQ(back.defects.first_out_of_range, place);
            expect_refused(text, {place, "4 vertices"}, true);
        }
    }
}

TEST_F(HostileInput, StrictRefusesShortFaces) {
    PlyMesh mesh = tetrahedron();
    mesh.faces[3] = {1, 2};
    expect_refused(test::ply_file(mesh), {"face 3", "fewer than three"}, true);
}

TEST_F(HostileInput, TheFirstDefectIsTheSameForAnyOrderOfMerging) {
    InputDefects a;
    a.first_nonfinite = "vertex 100 (byte 5)";
    InputDefects b;
    b.first_nonfinite = "vertex 99 (byte 4)";
    InputDefects ab = a;
    ab.merge(b);
    InputDefects ba = b;
    ba.merge(a);
    ba.merge({});
    EXPECT_EQ(ab.first_nonfinite, "vertex 99 (byte 4)");
    EXPECT_EQ(ba.first_nonfinite, ab.first_nonfinite);
}

TEST_F(HostileInput, WhatIsNoMeshIsCalledByItsName) {
    const std::string cloud =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0 0 0\n";
    expect_refused(cloud, {"point cloud"});
    expect_refused(replace(cloud, "end_header\n0 0 0",
                           "property float f_dc_0\nproperty float scale_0\nproperty float "
                           "rot_0\nend_header\n0 0 0 1 1 1"),
                   {"splat"});
    expect_refused("", {"empty"});
    expect_refused("\x1f\x8b\x08 zipped", {"gzip", "damaged"});
    expect_refused("PK\x03\x04 zipped", {"ZIP"});
    expect_refused("\x28\xb5\x2f\xfd zipped", {"Zstandard", "damaged"});
    expect_refused("just words\n", {"text", "PLY"});
    expect_refused(std::string("\x01\x02\x03", 3), {"not a mesh file"});
}

TEST_F(HostileInput, OtherKindsOfFilesAreAnsweredWithWhatTheyAre) {
    const auto bytes = [](const char* text, std::size_t n) { return std::string(text, n); };
    std::string tar(600, 'x');
    tar.replace(257, 5, "ustar");
    struct Case {
        std::string name;
        std::string content;
        std::string answer;
    };
    const std::vector<Case> cases{
        {"a.las", "LASF and so on", "a LAS or LAZ point cloud, which has no triangles"},
        {"a.laz", "LASF and so on", "a LAS or LAZ point cloud, which has no triangles"},
        {"a.e57", "ASTM-E57" + bytes("\1\0\0\0", 4), "an E57 point cloud"},
        {"a.pcd", "# .PCD v.7 - Point Cloud Data file format\n", "a PCD point cloud"},
        {"a.xyz", "1.5 2 3\n1 2 3e-5\n-1 2 3\n4 5 6\n", "points as text"},
        {"a.zip", "PK\x03\x04 zipped", "a ZIP archive; unpack it first"},
        {"a.3mf", "PK\x03\x04 zipped", "3MF; export it as"},
        {"a.usdz", "PK\x03\x04 zipped", "USD; export it as"},
        {"a.7z", "7z\xbc\xaf\x27\x1c\x01", "a 7-Zip archive"},
        {"a.rar", "Rar!\x1a\x07", "a RAR archive"},
        {"a.xz",
         bytes("\xfd"
               "7zXZ\0",
               6),
         "xz-compressed data"},
        {"a.tar", tar, "a tar archive; unpack it first"},
        {"a.tar.gz", test::gzip(tar), "a tar archive; unpack it first"},
        {"a.step", "ISO-10303-21;\nHEADER;\n", "STEP or IFC"},
        {"a.fbx", "Kaydara FBX Binary  ", "FBX; export it as"},
        {"b.fbx", "; FBX 7.4.0 project file\n", "FBX; export it as"},
        {"a.blend", "BLENDER-v300", "a Blender file"},
        {"a.usda", "#usda 1.0\n", "USD; export it as"},
        {"a.usdc", "PXR-USDC", "USD; export it as"},
        {"a.abc", "Ogawa" + bytes("\xff\0", 2), "Alembic"},
        {"a.dae", "<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">\n", "COLLADA"},
        {"a.x3d", "<?xml version=\"1.0\"?>\n<X3D profile=\"Interchange\">\n", "X3D"},
        {"a.wrl", "#VRML V2.0 utf8\n", "VRML"},
        {"a.vtk", "# vtk DataFile Version 3.0\n", "a legacy VTK file"},
        {"a.vtp", "<VTKFile type=\"PolyData\">\n", "a VTK XML file"},
        {"a.html", "<!DOCTYPE html>\n<html></html>\n", "an HTML page"},
        {"b.html", "\n<HTML><body></body></HTML>\n", "an HTML page"},
        {"a.pdf", "%PDF-1.7\n", "a PDF document"},
        {"a.json", "{\"a\": 1}\n", "JSON, but not glTF"},
        {"a.png", "\x89PNG\r\n\x1a\n", "a PNG image"},
        {"a.jpg", "\xff\xd8\xff\xe0 JFIF", "a JPEG image"},
        {"a.gif", "GIF89a", "a GIF image"},
        {"a.webp", "RIFF....WEBP", "a RIFF file"},
        {"a.tif", bytes("MM\0*", 4) + "data", "a TIFF image"},
        {"b.tif", bytes("II*\0", 4) + "data", "a TIFF image"},
        {"a.exr", "\x76\x2f\x31\x01", "an OpenEXR image"},
        {"a.obj",
         bytes("\xff\xfe"
               "v\0 \0",
               6),
         "text in UTF-16; convert it to UTF-8 first"},
    };
    for (const Case& c : cases) {
        expect_refused(c.content, {"this seems to be " + c.answer, "hewer reads PLY"}, false,
                       c.name);
    }
}

TEST_F(HostileInput, DirectoriesAndMissingFilesAreIoErrors) {
    EXPECT_THROW((void)open_mesh(dir_.path()), IoError);
    EXPECT_THROW((void)open_mesh(dir_.path() / "missing.ply"), IoError);
}

TEST_F(HostileInput, MutatedFilesAreReadOrRefused) {
    std::mt19937 random(7);
    for (int round = 0; round < 600; ++round) {
        PlyStyle style = in_format(std::array<const char*, 3>{
            "binary_little_endian", "binary_big_endian", "ascii"}[random() % 3]);
        style.has_extra_lists = random() % 2 == 0;
        style.has_extra_elements = random() % 2 == 0;
        style.has_strips = random() % 4 == 0;
        style.faces_first = random() % 2 == 0;
        std::string text = test::ply_file(tetrahedron(), style);
        for (std::size_t n = 1 + random() % 4; n > 0; --n) {
            text[4 + random() % (text.size() - 4)] = static_cast<char>(random());
        }
        if (random() % 4 == 0) text.resize(random() % text.size());
        try {
            for (const Triangle& t : read(text).mesh.triangles) {
                EXPECT_LT(std::max({t[0], t[1], t[2]}), text.size());
            }
        } catch (const FormatError&) {
            continue;  // as promised
        }
    }
}

TEST_F(HostileInput, SizesBeyondFourGiBAreNotCutShort) {
    // 400 M vertices of 12 bytes, mostly a hole in the file, then one face.
    const std::uint64_t n = 400'000'000;
    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 400000000\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar uint vertex_indices\nend_header\n";
    const std::filesystem::path path = dir_.write("sparse.ply", header);
    const std::uint64_t face_offset = header.size() + n * 12;
    std::error_code error;
    std::filesystem::resize_file(path, face_offset, error);
    if (error) GTEST_SKIP() << "no sparse files here: " << error.message();
    std::string face = test::ply_value("binary_little_endian", "uchar", 3);
    for (const double id : {0.0, 1.0, 399999999.0}) {
        face += test::ply_value("binary_little_endian", "uint", id);
    }
    std::ofstream(path, std::ios::binary | std::ios::app) << face;
    ASSERT_EQ(std::filesystem::file_size(path), face_offset + face.size());

    const auto source = open_mesh(path);
    ReadBack back;
    test::read_triangles(*source, back);
    EXPECT_EQ(back.mesh.triangles, (std::vector<Triangle>{{0, 1, 399999999}}));
    std::filesystem::resize_file(path, face_offset - 1);
    EXPECT_THROW((void)open_mesh(path), FormatError);
}

}  // namespace
}  // namespace hewer
