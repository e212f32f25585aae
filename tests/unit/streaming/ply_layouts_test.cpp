// SPDX-License-Identifier: MIT
/// Meshes in all layouts of PLY come back as they went in.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using test::PlyMesh;
using test::PlyStyle;
using test::ReadBack;

const std::array<std::string, 3> kFormats{"ascii", "binary_little_endian", "binary_big_endian"};

/// Coordinates that every scalar type can hold, signed ones at least.
PlyMesh random_mesh(unsigned seed, std::size_t n_vertices, std::size_t n_faces,
                    std::size_t max_corners) {
    std::mt19937 random(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::int64_t>(random() % n); };
    PlyMesh mesh;
    for (std::size_t i = 0; i < n_vertices; ++i) {
        mesh.positions.push_back({static_cast<double>(below(100)), static_cast<double>(below(100)),
                                  static_cast<double>(below(100))});
    }
    for (std::size_t i = 0; i < n_faces; ++i) {
        auto& face = mesh.faces.emplace_back();
        const std::size_t n = 3 + static_cast<std::size_t>(below(max_corners - 2));
        for (std::size_t k = 0; k < n; ++k) face.push_back(below(n_vertices));
    }
    return mesh;
}

std::vector<Triangle> fans(const PlyMesh& mesh) {
    std::vector<Triangle> triangles;
    for (const auto& face : mesh.faces) {
        for (std::size_t k = 2; k < face.size(); ++k) {
            triangles.push_back({static_cast<std::uint64_t>(face[0]),
                                 static_cast<std::uint64_t>(face[k - 1]),
                                 static_cast<std::uint64_t>(face[k])});
        }
    }
    return triangles;
}

void expect_same(const PlyMesh& mesh, const ReadBack& back) {
    EXPECT_EQ(back.mesh.positions, mesh.positions);
    EXPECT_EQ(back.mesh.triangles, fans(mesh));
    EXPECT_EQ(back.n_faces, mesh.faces.size());
    EXPECT_EQ(back.defects.nonfinite_vertices + back.defects.out_of_range_triangles +
                  back.defects.short_faces,
              0U);
}

class PlyLayouts : public ::testing::TestWithParam<std::string> {
  protected:
    PlyStyle style() const {
        PlyStyle s;
        s.format = GetParam();
        return s;
    }
    std::unique_ptr<MeshSource> open(const PlyMesh& mesh, const PlyStyle& s) const {
        return open_mesh(dir_.write("mesh.ply", test::ply_file(mesh, s)));
    }
    void expect_round_trip(const PlyMesh& mesh, const PlyStyle& s) const {
        const auto source = open(mesh, s);
        expect_same(mesh, test::read_all(*source));
        EXPECT_EQ(source->info().n_vertices, mesh.positions.size());
        EXPECT_EQ(source->info().n_faces, mesh.faces.size());
    }
    test::TempDir dir_;
};

INSTANTIATE_TEST_SUITE_P(Encodings, PlyLayouts, ::testing::ValuesIn(kFormats),
                         [](const auto& encoding) { return encoding.param; });

TEST_P(PlyLayouts, ReadsAllCoordinateTypes) {
    for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double",
                             "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32",
                             "float64", "int64", "uint64", "longlong"}) {
        SCOPED_TRACE(type);
        PlyStyle s = style();
        s.coordinate_type = type;
        expect_round_trip(random_mesh(1, 40, 30, 3), s);
    }
}

TEST_P(PlyLayouts, ReadsAllIndexAndCountTypes) {
    for (const char* index : {"char", "uchar", "short", "ushort", "int", "uint", "int32", "uint32",
                              "int64", "uint64", "long", "longlong", "ulong", "ulonglong"}) {
        for (const char* count : {"char", "uchar", "short", "ushort", "int", "uint", "uint64"}) {
            SCOPED_TRACE(std::string(count) + " " + index);
            PlyStyle s = style();
            s.index_type = index;
            s.count_type = count;
            s.index_name = "vertex_index";
            expect_round_trip(random_mesh(2, 100, 50, 3), s);
            expect_round_trip(random_mesh(3, 100, 50, 6), s);
        }
    }
}

TEST_P(PlyLayouts, RandomMeshesInRandomLayoutsComeBackEqual) {
    for (unsigned seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const auto coin = [&] { return random() % 2 == 0; };
        PlyStyle s = style();
        s.coordinate_type = coin() ? "double" : "float";
        s.count_type = coin() ? "uchar" : "int";
        s.index_type = coin() ? "int" : "uint";
        s.faces_first = coin();
        s.has_extra_scalars = coin();
        s.has_extra_lists = coin();
        s.has_extra_elements = coin();
        s.has_comments = coin();
        s.line_end = coin() ? "\n" : "\r\n";
        s.column_order = seed;
        const PlyMesh mesh =
            random_mesh(seed, 1 + random() % 500, 1 + random() % 900, coin() ? 3 : 7);
        const auto source = open(mesh, s);
        ReadBack back;
        if (coin()) {
            test::read_vertices(*source, back);
            test::read_triangles(*source, back);
        } else {
            test::read_triangles(*source, back);
            test::read_vertices(*source, back);
        }
        expect_same(mesh, back);
        expect_same(mesh, test::read_all(*source));  // and a second time
        const auto& ignored = source->info().ignored;
        EXPECT_EQ(std::count(ignored.begin(), ignored.end(), "vertex.confidence"),
                  s.has_extra_scalars ? 1 : 0);
        EXPECT_EQ(std::count(ignored.begin(), ignored.end(), "face.texcoord"),
                  s.has_extra_lists ? 1 : 0);
        EXPECT_EQ(std::count(ignored.begin(), ignored.end(), "element camera"),
                  s.has_extra_elements ? 1 : 0);
    }
}

TEST_P(PlyLayouts, ManyBlocksAreTheSameForAnyNumberOfThreads) {
    for (const std::size_t max_corners : {std::size_t{3}, std::size_t{5}}) {
        for (const bool faces_first : {false, true}) {
            SCOPED_TRACE(std::to_string(max_corners) + (faces_first ? " faces first" : ""));
            const PlyMesh mesh = random_mesh(5, 40000, 70000, max_corners);
            PlyStyle s = style();
            s.faces_first = faces_first;
            s.has_extra_lists = faces_first;
            const auto source = open(mesh, s);
            const ReadBack one = test::read_all(*source, 1);
            const ReadBack four = test::read_all(*source, 4);
            expect_same(mesh, one);
            expect_same(mesh, four);
            EXPECT_EQ(one.batches, four.batches);
            EXPECT_GE(one.batches.size(), 4U);
            EXPECT_GE(source->bytes_read(), source->info().n_bytes);
        }
    }
}

TEST_P(PlyLayouts, ReadsColoursOfAllTypesAndNames) {
    struct Case {
        const char* type;
        double scale;
        std::array<std::string, 4> names;
    };
    const std::array<Case, 4> cases{{
        {"uchar", 1, {"red", "green", "blue", "alpha"}},
        {"ushort", 257, {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}},
        {"float", 1 / 255.0, {"r", "g", "b", "a"}},
        {"double", 1 / 255.0, {"red", "green", "blue", "alpha"}},
    }};
    for (const Case& c : cases) {
        for (const bool has_alpha : {false, true}) {
            SCOPED_TRACE(c.type);
            PlyMesh mesh = random_mesh(7, 256, 10, 3);
            for (int i = 0; i < 256; ++i) {
                mesh.colors.push_back(
                    {i * c.scale, (255 - i) * c.scale, 17 * c.scale, 200 * c.scale});
            }
            PlyStyle s = style();
            s.color_type = c.type;
            s.color_names = c.names;
            s.has_alpha = has_alpha;
            s.column_order = has_alpha ? 3 : 0;
            const auto source = open(mesh, s);
            EXPECT_TRUE(source->info().has_colors);
            EXPECT_EQ(source->info().has_alpha, has_alpha);
            const ReadBack back = test::read_all(*source);
            ASSERT_EQ(back.mesh.colors.size(), 256U);
            for (unsigned i = 0; i < 256; ++i) {
                const Rgba16 expected{static_cast<std::uint16_t>(i * 257),
                                      static_cast<std::uint16_t>((255 - i) * 257), 17 * 257,
                                      static_cast<std::uint16_t>(has_alpha ? 200 * 257 : 65535)};
                ASSERT_EQ(back.mesh.colors[i], expected) << i;
            }
        }
    }
}

TEST_P(PlyLayouts, ReadsNormals) {
    PlyMesh mesh = random_mesh(8, 100, 10, 3);
    for (std::size_t i = 0; i < 100; ++i) {
        mesh.normals.push_back({0.5, -0.25, static_cast<double>(i)});
    }
    PlyStyle s = style();
    s.normal_type = "double";
    s.column_order = 11;
    const auto source = open(mesh, s);
    EXPECT_TRUE(source->info().has_normals);
    EXPECT_FALSE(source->info().has_double_positions);
    const ReadBack back = test::read_all(*source);
    ASSERT_EQ(back.mesh.normals.size(), 100U);
    EXPECT_EQ(back.mesh.normals[42], (std::array<float, 3>{0.5F, -0.25F, 42.0F}));
}

TEST_P(PlyLayouts, KeepsDoublesExactAndRoundsFloatsToFloats) {
    PlyMesh mesh = random_mesh(9, 3, 1, 3);
    mesh.positions[1] = {499123.1234567891, 5421350.000001, 1e-300};
    PlyStyle s = style();
    s.coordinate_type = "double";
    const auto exact = open(mesh, s);
    EXPECT_TRUE(exact->info().has_double_positions);
    EXPECT_EQ(test::read_all(*exact).mesh.positions[1], mesh.positions[1]);
    s.coordinate_type = "float";
    const auto rounded = open(mesh, s);
    EXPECT_FALSE(rounded->info().has_double_positions);
    EXPECT_EQ(test::read_all(*rounded).mesh.positions[1][0],
              static_cast<double>(static_cast<float>(mesh.positions[1][0])));
}

TEST_P(PlyLayouts, UnrollsTriangleStrips) {
    PlyMesh mesh = random_mesh(10, 20, 0, 3);
    // A strip, a new one after -1, one with a stitch (3 3), and a second row.
    mesh.faces = {{0, 1, 2, 3, 4, -1, 5, 6, 7, -1, 1, 2, 3, 3, 4, 5}, {7, 8, 9, 10}};
    PlyStyle s = style();
    s.has_strips = true;
    s.count_type = "int";
    s.faces_first = true;
    s.has_extra_lists = true;
    const auto source = open(mesh, s);
    const std::vector<Triangle> expected{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {5, 6, 7},
                                         {1, 2, 3}, {4, 3, 5}, {7, 8, 9}, {9, 8, 10}};
    EXPECT_EQ(source->info().n_faces, expected.size());
    const ReadBack back = test::read_all(*source, 2);
    EXPECT_EQ(back.mesh.triangles, expected);
    EXPECT_EQ(back.mesh.positions, mesh.positions);
}

TEST_P(PlyLayouts, UnrollsOneStripOverManyBatches) {
    PlyMesh mesh = random_mesh(11, 100, 0, 3);
    auto& strip = mesh.faces.emplace_back();
    for (int i = 0; i < 100002; ++i) strip.push_back(i % 100);
    PlyStyle s = style();
    s.has_strips = true;
    s.count_type = "int";
    const auto source = open(mesh, s);
    const ReadBack back = test::read_all(*source, 3);
    ASSERT_EQ(back.mesh.triangles.size(), 100000U);
    EXPECT_EQ(back.mesh.triangles[50001], (Triangle{2, 1, 3}));
    EXPECT_EQ(source->info().n_faces, 100000U);
}

TEST_P(PlyLayouts, ReadsAPolygonLargerThanABlock) {
    PlyMesh mesh = random_mesh(12, 50, 0, 3);
    mesh.faces.push_back({0, 1, 2});
    auto& large = mesh.faces.emplace_back();
    for (int i = 0; i < 400000; ++i) large.push_back(i % 50);
    mesh.faces.push_back({3, 4, 5});
    PlyStyle s = style();
    s.count_type = "uint";
    const auto source = open(mesh, s);
    const ReadBack back = test::read_all(*source, 2);
    expect_same(mesh, back);
    EXPECT_EQ(back.defects.polygons, 1U);
}

TEST_P(PlyLayouts, CountsShortFacesAndKeepsTheRest) {
    PlyMesh mesh = random_mesh(13, 10, 0, 3);
    mesh.faces = {{0, 1, 2}, {4, 5}, {}, {6}, {7, 8, 9, 0}};
    const auto source = open(mesh, style());
    const ReadBack back = test::read_all(*source);
    EXPECT_EQ(back.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {7, 8, 9}, {7, 9, 0}}));
    EXPECT_EQ(back.defects.short_faces, 3U);
    EXPECT_EQ(back.defects.polygons, 1U);
    EXPECT_EQ(back.n_faces, 5U);
}

TEST_P(PlyLayouts, CountsTheBytesBehindTheMesh) {
    const PlyMesh mesh = random_mesh(17, 40000, 50000, 3);
    PlyStyle s = style();
    s.has_extra_elements = false;
    s.has_strips = false;
    s.faces_first = false;
    const std::string whole = test::ply_file(mesh, s);
    const test::TempDir dir;
    const auto trailing = [&](const std::string& more) {
        const auto source = open_mesh(dir.write("a.ply", whole + more));
        return test::read_all(*source, 2).defects.trailing_bytes;
    };
    EXPECT_EQ(trailing(""), 0U);
    EXPECT_EQ(trailing("ply\n"), 4U);
    EXPECT_EQ(trailing(" \r\n"), s.format == "ascii" ? 0U : 3U);
}

TEST(AsciiPly, RowsNeedNotBeLines) {
    const test::TempDir dir;
    const PlyMesh mesh = random_mesh(14, 3000, 5000, 5);
    PlyStyle s;
    s.format = "ascii";
    s.has_extra_scalars = true;
    for (const char* token_end : {"\n", " \t\r\n\n", "  "}) {
        for (const char* row_end : {"\n", " ", "\r\n\r\n"}) {
            s.token_end = token_end;
            s.row_end = row_end;
            const auto source = open_mesh(dir.write("mesh.ply", test::ply_file(mesh, s)));
            expect_same(mesh, test::read_all(*source, 2));
        }
    }
}

TEST(AsciiPly, NeedsNoLineEndAtTheEndOfTheFile) {
    const test::TempDir dir;
    const auto source = open_mesh(
        dir.write("mesh.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nelement face 1\nproperty list uchar int vertex_index\n"
                  "end_header\n0 0 0\n+1 -0.5e1 1E2\n.5 5. 1e-3\n3 0 1 2"));
    const ReadBack back = test::read_all(*source);
    EXPECT_EQ(back.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(back.mesh.positions[1], (Vec3{1, -5, 100}));
    EXPECT_EQ(back.mesh.positions[2], (Vec3{0.5, 5, static_cast<double>(1e-3F)}));
}

TEST(PlyHeader, MayEndItsLinesWithCarriageReturnsAlone) {
    const test::TempDir dir;
    PlyMesh mesh = random_mesh(15, 10, 10, 3);
    PlyStyle s;
    s.line_end = "\r";
    const auto source = open_mesh(dir.write("mesh.ply", test::ply_file(mesh, s)));
    expect_same(mesh, test::read_all(*source));
}

TEST(PlyHeader, MayBeLong) {
    const test::TempDir dir;
    const PlyMesh mesh = random_mesh(16, 10, 10, 3);
    std::string text = test::ply_file(mesh);
    std::string comments;
    for (int i = 0; i < 3000; ++i) comments += "comment " + std::string(200, 'x') + "\n";
    text.insert(text.find("element"), comments);
    const auto source = open_mesh(dir.write("mesh.ply", text));
    expect_same(mesh, test::read_all(*source));
}

}  // namespace
}  // namespace hewer
