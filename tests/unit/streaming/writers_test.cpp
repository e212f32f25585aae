// SPDX-License-Identifier: MIT
/// What is written, read back by parsers that share nothing with the library.
#include <gtest/gtest.h>

#include <cmath>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "hewer/version.h"
#include "streaming/gltf_text.h"
#include "streaming/mesh_writer.h"
#include "tests/support/temp_dir.h"
#include "tests/unit/streaming/parsed_mesh.h"
#include "tests/unit/streaming/sample_mesh.h"

namespace hewer {
namespace {

using test::TempDir;
using tests::header_of;
using tests::ParsedMesh;
using tests::pour;
using tests::wavy_sheet;

constexpr Vec3 kNear{0.25, -0.5, 1};
constexpr Vec3 kMap{5'000'123.25, 448'017.5,
                    312.125};  // UTM: metres, seven digits before the point

class Writers : public testing::Test {
  protected:
    std::filesystem::path write(const Mesh& mesh, const std::string& name) {
        const std::filesystem::path path = folder_.path() / name;
        const std::unique_ptr<MeshSink> sink = create_mesh_file(path);
        pour(mesh, *sink);
        EXPECT_EQ(sink->bytes_written(), std::filesystem::file_size(path));
        EXPECT_EQ(folder_.n_entries(), 1U) << "a temporary file is left";
        return path;
    }
    static void expect_triangles(const ParsedMesh& parsed, const Mesh& mesh) {
        ASSERT_EQ(parsed.triangles.size(), mesh.triangles.size());
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            ASSERT_EQ(parsed.triangles[i], mesh.triangles[i]) << i;
        }
    }
    /// Largest error of a coordinate.
    static double position_error(const ParsedMesh& parsed, const Mesh& mesh) {
        EXPECT_EQ(parsed.positions.size(), mesh.positions.size());
        double worst = 0;
        for (std::size_t i = 0; i < parsed.positions.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                worst = std::max(worst, std::abs(parsed.positions[i][k] + parsed.translation[k] -
                                                 mesh.positions[i][k]));
            }
        }
        return worst;
    }
    static void expect_normals(const ParsedMesh& parsed, const Mesh& mesh, double tolerance) {
        ASSERT_EQ(parsed.normals.size(), mesh.normals.size());
        for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                ASSERT_NEAR(parsed.normals[i][k], static_cast<double>(mesh.normals[i][k]),
                            tolerance);
            }
        }
    }
    static bool has_line(const ParsedMesh& parsed, const std::string& line) {
        return std::find(parsed.header.begin(), parsed.header.end(), line) != parsed.header.end();
    }

    TempDir folder_;
};

TEST_F(Writers, PlyKeepsPositionsNormalsAndColors) {
    const Mesh mesh = wavy_sheet(40, 1, kNear);
    const ParsedMesh parsed = tests::parse_ply(write(mesh, "a.ply"));
    EXPECT_TRUE(has_line(parsed, "property float x"));
    EXPECT_TRUE(has_line(parsed, "comment written by hewer " + std::string(version())));
    expect_triangles(parsed, mesh);
    EXPECT_LE(position_error(parsed, mesh), 1e-7);
    expect_normals(parsed, mesh, 0);
    ASSERT_EQ(parsed.colors.size(), mesh.colors.size());
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(parsed.colors[i][c] * 257, mesh.colors[i][c]);
        }
        ASSERT_EQ(parsed.colors[i][3], -1) << "alpha was not announced";
    }
}

TEST_F(Writers, PlyRoundsWideColorsToTheNearestAndKeepsAlpha) {
    Mesh mesh = wavy_sheet(2, 1, kNear);
    mesh.colors = {{0, 128, 129, 65534}, {65535, 65407, 65406, 65535}, {257, 385, 386, 0}, {}};
    const ParsedMesh parsed = tests::parse_ply(write(mesh, "a.ply"));
    EXPECT_EQ(parsed.colors[0], (std::array<double, 4>{0, 0, 1, 255}));
    EXPECT_EQ(parsed.colors[1], (std::array<double, 4>{255, 255, 254, 255}));
    EXPECT_EQ(parsed.colors[2], (std::array<double, 4>{1, 1, 2, 0}));
}

TEST_F(Writers, PlyHoldsMapCoordinatesExactly) {
    Mesh mesh = wavy_sheet(40, 1000, kMap);
    const ParsedMesh parsed = tests::parse_ply(write(mesh, "a.ply"));
    EXPECT_TRUE(has_line(parsed, "property double z"));
    EXPECT_EQ(position_error(parsed, mesh), 0);
}

TEST_F(Writers, PlyOfFloatInputStaysFloat) {
    const Mesh mesh = wavy_sheet(4, 1000, kMap);
    SinkHeader header = header_of(mesh);
    header.has_double_positions = false;
    const std::unique_ptr<MeshSink> sink = create_mesh_file(folder_.path() / "a.ply");
    sink->begin(header);
    sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
    sink->add_triangles(mesh.triangles);
    sink->finish();
    EXPECT_TRUE(has_line(tests::parse_ply(folder_.path() / "a.ply"), "property float x"));
}

TEST_F(Writers, PlyAndObjOfNothingAreValid) {
    const Mesh mesh;
    EXPECT_TRUE(tests::parse_ply(write(mesh, "a.ply")).positions.empty());
    std::filesystem::remove(folder_.path() / "a.ply");
    EXPECT_TRUE(tests::parse_obj(write(mesh, "a.obj")).positions.empty());
}

TEST_F(Writers, ObjReadsBackAsTheSameFloats) {
    const Mesh mesh = wavy_sheet(40, 1, kNear);
    const ParsedMesh parsed = tests::parse_obj(write(mesh, "a.obj"));
    expect_triangles(parsed, mesh);
    ASSERT_EQ(parsed.positions.size(), mesh.positions.size());
    ASSERT_EQ(parsed.normals.size(), mesh.normals.size());
    ASSERT_EQ(parsed.colors.size(), mesh.colors.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_EQ(static_cast<float>(parsed.positions[i][k]),
                      static_cast<float>(mesh.positions[i][k]));
            ASSERT_EQ(static_cast<float>(parsed.normals[i][k]), mesh.normals[i][k]);
            ASSERT_EQ(std::lround(parsed.colors[i][k] * 65535), mesh.colors[i][k]);
        }
    }
}

TEST_F(Writers, ObjTellsAllSixteenBitColorsApart) {
    Mesh mesh;
    for (unsigned v = 0; v < 65536; v += 3) {
        const auto c = [&](unsigned w) { return static_cast<std::uint16_t>(std::min(w, 65535U)); };
        mesh.positions.push_back({1, 2, 3});
        mesh.colors.push_back({c(v), c(v + 1), c(v + 2), 65535});
    }
    const ParsedMesh parsed = tests::parse_obj(write(mesh, "a.obj"));
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_EQ(std::lround(parsed.colors[i][k] * 65535), mesh.colors[i][k]);
        }
    }
}

TEST_F(Writers, ObjWritesMapCoordinatesWithTheDigitsOfDoubles) {
    Mesh mesh = wavy_sheet(40, 1000, kMap);
    mesh.normals.clear();
    mesh.colors.clear();
    const ParsedMesh parsed = tests::parse_obj(write(mesh, "a.obj"));
    expect_triangles(parsed, mesh);
    EXPECT_EQ(position_error(parsed, mesh), 0);
}

TEST_F(Writers, ObjSurvivesTheLongestAndTheSmallestNumbers) {
    Mesh mesh;
    mesh.positions = {{-1.2345678901234567e-5, -2.2250738585072014e-308, 1.2345678901234567e16},
                      {-9.8765432109876543e15, -0.0, 5e-324},
                      {1.7976931348623157e308, -1.7976931348623157e308, 1}};
    const ParsedMesh parsed = tests::parse_obj(write(mesh, "a.obj"));
    EXPECT_EQ(position_error(parsed, mesh), 0);
}

TEST_F(Writers, StlHoldsCornersAndUnitNormals) {
    const Mesh mesh = wavy_sheet(40, 1, kNear);
    const ParsedMesh parsed = tests::parse_stl(write(mesh, "a.stl"));
    ASSERT_EQ(parsed.triangles.size(), mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                ASSERT_EQ(static_cast<float>(parsed.positions[3 * i + k][axis]),
                          static_cast<float>(mesh.positions[mesh.triangles[i][k]][axis]));
            }
        }
        const auto& n = parsed.normals[i];
        ASSERT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-6);
        ASSERT_GT(n[2], 0.9) << "counter-clockwise seen from above";
    }
}

TEST_F(Writers, StlNormalOfAFacetWithoutAreaIsZero) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    mesh.triangles = {{0, 1, 2}};
    const ParsedMesh parsed = tests::parse_stl(write(mesh, "a.stl"));
    EXPECT_EQ(parsed.normals[0], (std::array<double, 3>{0, 0, 0}));
}

TEST_F(Writers, GlbKeepsPositionsNormalsAndItsExactBox) {
    const Mesh mesh = wavy_sheet(40, 1, kNear);
    const ParsedMesh parsed = tests::parse_glb(write(mesh, "a.glb"));
    expect_triangles(parsed, mesh);
    EXPECT_EQ(parsed.translation, (std::array<double, 3>{0, 0, 0}));
    EXPECT_LE(position_error(parsed, mesh), 1e-7);
    expect_normals(parsed, mesh, 1e-6);
    EXPECT_EQ(parsed.generator, "hewer " + std::string(version()));
    Bounds box;
    for (const auto& p : parsed.positions) box.extend(p);
    EXPECT_EQ(parsed.min, box.min);
    EXPECT_EQ(parsed.max, box.max);
}

TEST_F(Writers, GlbColorsAreLinearLightAndKeepAllStepsApart) {
    Mesh mesh = wavy_sheet(40, 1, kNear);
    const ParsedMesh parsed = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_EQ(parsed.alpha_mode, "OPAQUE");
    ASSERT_EQ(parsed.colors.size(), mesh.colors.size());
    for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            // Back to sRGB, to the 8-bit step that it came from.
            const double linear = parsed.colors[i][k] / 65535;
            const double srgb =
                linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
            ASSERT_EQ(std::lround(srgb * 255) * 257, mesh.colors[i][k]);
        }
        ASSERT_EQ(parsed.colors[i][3], 65535);
    }
    // A middle grey, by hand: ((0.5 + 0.055) / 1.055)^2.4 = 0.21404.
    mesh.colors[0] = {32768, 0, 65535, 65535};
    std::filesystem::remove(folder_.path() / "a.glb");
    const ParsedMesh grey = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_NEAR(grey.colors[0][0] / 65535, 0.21404, 2e-5);
    EXPECT_EQ(grey.colors[0][1], 0);
    EXPECT_EQ(grey.colors[0][2], 65535);
}

TEST_F(Writers, GlbBlendsOnlyWhatIsTransparent) {
    const ParsedMesh parsed = tests::parse_glb(write(wavy_sheet(4, 1, kNear, 0x8000), "a.glb"));
    EXPECT_EQ(parsed.alpha_mode, "BLEND");
    EXPECT_EQ(parsed.colors[0][3], 0x8000);
}

TEST_F(Writers, GlbKeepsMapCoordinatesByATranslationThatIsAFloatItself) {
    const Mesh mesh = wavy_sheet(40, 1000, kMap);
    const ParsedMesh parsed = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_LE(position_error(parsed, mesh), 1e-4);  // metres
    for (const double x : parsed.translation) {
        EXPECT_EQ(static_cast<double>(static_cast<float>(x)), x);
    }
}

TEST_F(Writers, GlbIndicesAreShortUpTo65535Vertices) {
    Mesh mesh;
    mesh.positions.resize(65535);
    mesh.positions[65534] = {1, 1, 0};
    mesh.positions[1] = {1, 0, 0};
    mesh.triangles = {{0, 1, 65534}};
    ParsedMesh parsed = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_TRUE(parsed.has_short_indices);
    expect_triangles(parsed, mesh);
    mesh.positions.push_back({0, 1, 0});
    mesh.triangles.push_back({0, 65534, 65535});
    std::filesystem::remove(folder_.path() / "a.glb");
    parsed = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_FALSE(parsed.has_short_indices);
    expect_triangles(parsed, mesh);
}

TEST_F(Writers, GlbNormalsAreMadeUnitLength) {
    Mesh mesh = wavy_sheet(2, 1, kNear);
    mesh.normals = {{2, 0, 0}, {0, 0, 0}, {0, std::nanf(""), 0}, {1e-30F, 1e-30F, 0}};
    const ParsedMesh parsed = tests::parse_glb(write(mesh, "a.glb"));
    EXPECT_EQ(parsed.normals[0], (std::array<double, 3>{1, 0, 0}));
    EXPECT_EQ(parsed.normals[1], (std::array<double, 3>{0, 0, 1}));
    EXPECT_EQ(parsed.normals[2], (std::array<double, 3>{0, 0, 1}));
    EXPECT_NEAR(parsed.normals[3][0], std::sqrt(0.5), 1e-7);
}

TEST_F(Writers, ExtensionsAreReadWithoutRegardToCase) {
    const Mesh mesh = wavy_sheet(3, 1, kNear);
    EXPECT_EQ(tests::parse_ply(write(mesh, "A.PLY")).triangles.size(), mesh.triangles.size());
    std::filesystem::remove(folder_.path() / "A.PLY");
    EXPECT_EQ(tests::parse_glb(write(mesh, "A.Glb")).triangles.size(), mesh.triangles.size());
}

TEST_F(Writers, SameMeshGivesTheSameBytes) {
    const Mesh mesh = wavy_sheet(20, 1000, kMap);
    for (const std::string extension : {".ply", ".obj", ".off", ".stl", ".glb", ".drc"}) {
        const std::string first = tests::read_whole(write(mesh, "a" + extension));
        std::filesystem::remove(folder_.path() / ("a" + extension));
        const auto sink = create_mesh_file(folder_.path() / ("a" + extension));
        sink->begin(header_of(mesh));
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            sink->add_vertices({std::span(mesh.positions).subspan(i, 1),
                                std::span(mesh.normals).subspan(i, 1),
                                std::span(mesh.colors).subspan(i, 1)});
        }
        for (const Triangle& t : mesh.triangles) sink->add_triangles({&t, 1});
        sink->finish();
        EXPECT_TRUE(tests::read_whole(folder_.path() / ("a" + extension)) == first) << extension;
        std::filesystem::remove(folder_.path() / ("a" + extension));
    }
}

TEST(GltfText, LongestOneFitsInThePlaceKeptForIt) {
    streaming::GltfLayout layout;
    layout.n_vertices = layout.n_triangles = 0xFFFFFFFF;
    layout.has_normals = layout.has_colors = layout.has_transparency = true;
    layout.min.fill(-1.2345678901234567e-38);
    layout.max.fill(-1.2345678901234567e-38);
    layout.translation.fill(-1.2345678901234567e-300);
    for (const double step : {0.0, 1.2345678901234567e-300}) {
        layout.step = step;
        EXPECT_LT(streaming::gltf_text(layout).size(), 1600U);
    }
    EXPECT_LT(1600U, streaming::kGltfTextBytes);
}

TEST(RequireFormatFits, RefusesWhatBeginWouldRefuse) {
    SinkHeader header;
    header.n_vertices = 200'000'000;
    header.n_triangles = 400'000'000;
    for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.gltf", "a.drc"}) {
        EXPECT_NO_THROW(streaming::require_format_fits(name, header)) << name;
    }
    EXPECT_THROW(streaming::require_format_fits("a.glb", header), InvalidArgument);
    header.n_triangles = std::uint64_t{1} << 32;
    EXPECT_THROW(streaming::require_format_fits("a.stl", header), InvalidArgument);
    EXPECT_NO_THROW(streaming::require_format_fits("a.ply", header));
    header.n_vertices = (std::uint64_t{1} << 32) + 1;
    EXPECT_THROW(streaming::require_format_fits("a.ply", header), InvalidArgument);
    EXPECT_NO_THROW(streaming::require_format_fits("a.obj", header));
    EXPECT_THROW(streaming::require_format_fits("a.txt", header), InvalidArgument);
}

TEST(StlPoints, GiveTheSameFileAsVerticesAndTriangles) {
    const test::TempDir folder;
    const Mesh mesh = tests::wavy_sheet(40, 3, {1, 2, 3});
    {
        const auto sink = create_mesh_file(folder.path() / "indexed.stl");
        tests::pour(mesh, *sink);
    }
    {
        const auto sink = create_mesh_file(folder.path() / "points.stl");
        ASSERT_TRUE(sink->takes_points());
        sink->begin(tests::header_of(mesh));
        std::vector<std::array<Vec3, 3>> points;
        for (const Triangle& t : mesh.triangles) {
            points.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
        }
        sink->add_points(std::span(points).first(100));
        EXPECT_THROW(sink->add_vertices({mesh.positions, mesh.normals, mesh.colors}),
                     InternalError);
        EXPECT_THROW(sink->add_points(points), InternalError) << "more than announced";
        sink->add_points(std::span(points).subspan(100));
        sink->finish();
    }
    EXPECT_EQ(tests::read_whole(folder.path() / "points.stl"),
              tests::read_whole(folder.path() / "indexed.stl"));
}

TEST(StlPoints, AreForStlOnly) {
    const test::TempDir folder;
    const std::vector<std::array<Vec3, 3>> points(1);
    Mesh collected;
    std::vector<std::unique_ptr<MeshSink>> sinks;
    for (const char* name : {"a.ply", "a.obj", "a.off", "a.glb", "a.gltf", "a.drc"}) {
        sinks.push_back(create_mesh_file(folder.path() / name));
    }
    sinks.push_back(collect_mesh(collected));
    for (const auto& sink : sinks) {
        EXPECT_FALSE(sink->takes_points());
        sink->begin(tests::header_of(tests::wavy_sheet(3, 1, {0, 0, 0})));
        EXPECT_THROW(sink->add_points(points), InternalError);
    }
}

}  // namespace
}  // namespace hewer
