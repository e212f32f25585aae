// SPDX-License-Identifier: MIT
/// Each cell of the matrix in docs/output_formats.md: what a file of each kind keeps of a mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"
#include "tests/unit/streaming/parsed_mesh.h"
#include "tests/unit/streaming/sample_mesh.h"

namespace hewer {
namespace {

struct Choice {
    const char* name;
    const char* extension;
    MeshFileOptions options;
    bool keeps_order = true;   // of vertices
    bool keeps_offset = true;  // coordinates far from the origin
    double normal_error = 1e-6;
    bool keeps_colors = true;  // and normals
    bool keeps_alpha = true;
};

std::ostream& operator<<(std::ostream& out, const Choice& choice) {
    return out << choice.name;
}

MeshFileOptions with(Compression compression, Quantization quantization = {}) {
    return {.quantization = quantization, .compression = compression};
}

const Quantization kAuto{Quantization::Kind::Auto, 0};
const Quantization kBits{Quantization::Kind::Bits, 14};

std::vector<Choice> choices() {
    std::vector<Choice> all{
        {"ply", ".ply", {}},
        {"ply_ascii", ".ply", {.is_ascii = true}},
        {"obj", ".obj", {}, true, true, 1e-6, true, false},
        {"off", ".off", {}},
        {"stl", ".stl", {}, false, false, 1e-6, false, false},
        {"drc", ".drc", {}, false, false, 0.01},
        {"drc_14bit", ".drc", {.quantization = kBits}, false, false, 0.01},
    };
    static const std::array<std::string, 12> kNames{
        "glb",          "glb_auto",           "glb_meshopt", "glb_meshopt_14bit",
        "glb_draco",    "glb_draco_14bit",    "gltf",        "gltf_auto",
        "gltf_meshopt", "gltf_meshopt_14bit", "gltf_draco",  "gltf_draco_14bit"};
    std::size_t i = 0;
    for (const char* extension : {".glb", ".gltf"}) {
        for (const auto compression :
             {Compression::None, Compression::Meshopt, Compression::Draco}) {
            const bool is_draco = compression == Compression::Draco;
            const Quantization fine = compression == Compression::None ? kAuto : kBits;
            all.push_back({kNames[i++].c_str(), extension, with(compression), !is_draco, true,
                           is_draco ? 0.01 : 1e-6});
            all.push_back(
                {kNames[i++].c_str(), extension, with(compression, fine), !is_draco, true, 0.02});
        }
    }
    return all;
}

/// The triangles as their corners' positions, the least corner first, sorted: whatever the order.
std::vector<std::array<Vec3, 3>> surface_of(const Mesh& mesh) {
    std::vector<std::array<Vec3, 3>> surface;
    for (const Triangle& t : mesh.triangles) {
        std::array<Vec3, 3> corners{mesh.positions[t[0]], mesh.positions[t[1]],
                                    mesh.positions[t[2]]};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                    corners.end());
        surface.push_back(corners);
    }
    std::sort(surface.begin(), surface.end());
    return surface;
}

class OutputChoices : public testing::TestWithParam<Choice> {
  protected:
    struct Written {
        test::ReadBack back;
        SourceInfo info;
        double displacement = 0;
    };
    /// Writes and reads `mesh`; an error of a thousandth of its size.
    Written write(const Mesh& mesh) {
        const auto path = folder_.path() / (std::string("out") + GetParam().extension);
        SinkHeader header = tests::header_of(mesh);
        header.error = 1e-3 * header.bounds.diagonal();
        const auto sink = create_mesh_file(path, GetParam().options);
        sink->begin(header);
        sink->add_vertices({mesh.positions, mesh.normals, mesh.colors});
        sink->add_triangles(mesh.triangles);
        sink->finish();
        Written written;
        written.displacement = sink->displacement();
        const auto source = open_mesh(path);
        written.info = source->info();
        written.back = test::read_all(*source);
        for (const auto& corners : written.back.soup) {
            Mesh& m = written.back.mesh;
            const std::uint64_t v = m.positions.size();
            m.positions.insert(m.positions.end(), corners.begin(), corners.end());
            m.triangles.push_back({v, v + 1, v + 2});
        }
        std::uint64_t bytes = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
            bytes += entry.file_size();
        }
        EXPECT_EQ(sink->bytes_written(), bytes);
        return written;
    }
    /// For each vertex that was read, the one that was written next to it.
    static std::vector<std::size_t> partners(const Mesh& mesh, const Mesh& back) {
        std::vector<std::size_t> result;
        for (const Vec3& p : back.positions) {
            std::size_t best = 0;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
                const Vec3& q = mesh.positions[v];
                const double d = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
                if (d < least) {
                    least = d;
                    best = v;
                }
            }
            result.push_back(best);
        }
        return result;
    }

    test::TempDir folder_;
};

INSTANTIATE_TEST_SUITE_P(All, OutputChoices, testing::ValuesIn(choices()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(OutputChoices, KeepTheSurfaceToWithinTheDisplacementThatTheyTell) {
    const Mesh mesh = tests::wavy_sheet(30, 2, {0.25, -0.5, 1});
    const Written written = write(mesh);
    const double allowed = written.displacement + 1e-6;
    EXPECT_LE(written.displacement, 1e-4 * 3.0);
    const auto expected = surface_of(mesh);
    ASSERT_EQ(written.back.mesh.triangles.size(), expected.size());
    const std::vector<std::size_t> partner = partners(mesh, written.back.mesh);
    for (std::size_t v = 0; v < partner.size(); ++v) {
        const Vec3& p = written.back.mesh.positions[v];
        const Vec3& q = mesh.positions[partner[v]];
        EXPECT_LE(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), allowed);
        if (GetParam().keeps_order) {
            EXPECT_EQ(partner[v], v);
        }
    }
    Mesh matched = mesh;
    matched.triangles = written.back.mesh.triangles;
    for (Triangle& t : matched.triangles) {
        for (std::uint64_t& v : t) v = partner[v];
    }
    EXPECT_EQ(surface_of(matched), expected);
    // meshoptimizer turns triangles so that another of their corners is the first.
    if (GetParam().keeps_order && GetParam().options.compression == Compression::None) {
        EXPECT_EQ(written.back.mesh.triangles, mesh.triangles);
    }
}

TEST_P(OutputChoices, KeepNormalsColoursAndAlpha) {
    const Mesh mesh = tests::wavy_sheet(30, 2, {0.25, -0.5, 1}, 0x8080);
    const Written written = write(mesh);
    const Mesh& back = written.back.mesh;
    EXPECT_EQ(written.info.has_alpha, GetParam().keeps_alpha);
    EXPECT_EQ(written.info.has_colors, GetParam().keeps_colors);
    if (!GetParam().keeps_colors) return;
    ASSERT_EQ(back.normals.size(), back.positions.size());
    ASSERT_EQ(back.colors.size(), back.positions.size());
    const std::vector<std::size_t> partner = partners(mesh, back);
    for (std::size_t v = 0; v < partner.size(); ++v) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(back.normals[v][k], mesh.normals[partner[v]][k], GetParam().normal_error);
        }
        for (std::size_t k = 0; k < (GetParam().keeps_alpha ? 4U : 3U); ++k) {
            EXPECT_EQ((back.colors[v][k] + 128) / 257, (mesh.colors[partner[v]][k] + 128) / 257);
        }
    }
}

TEST_P(OutputChoices, HaveNoAttributesThatTheMeshHasNot) {
    Mesh mesh = tests::wavy_sheet(30, 2, {0.25, -0.5, 1});
    mesh.normals.clear();
    mesh.colors.clear();
    const Written written = write(mesh);
    EXPECT_FALSE(written.info.has_normals);
    EXPECT_EQ(written.back.mesh.triangles.size(), mesh.triangles.size());
}

TEST_P(OutputChoices, KeepCoordinatesFarFromTheOriginWhereTheyCan) {
    const Mesh mesh = tests::wavy_sheet(30, 100, {5'000'123.25, 448'017.5, 312.125});
    const Written written = write(mesh);
    EXPECT_EQ(written.info.has_double_positions, GetParam().keeps_offset);
    const double allowed = (GetParam().keeps_offset ? 1e-5 : 0.5) + written.displacement;
    const std::vector<std::size_t> partner = partners(mesh, written.back.mesh);
    for (std::size_t v = 0; v < partner.size(); ++v) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(written.back.mesh.positions[v][k], mesh.positions[partner[v]][k], allowed);
        }
    }
}

TEST_P(OutputChoices, GiveTheSameBytesForAnyCutOfTheMesh) {
    const Mesh mesh = tests::wavy_sheet(20, 2, {0, 0, 0});
    std::vector<std::string> files;
    for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, mesh.positions.size()}) {
        const test::TempDir folder;
        const auto path = folder.path() / (std::string("out") + GetParam().extension);
        const auto sink = create_mesh_file(path, GetParam().options);
        SinkHeader header = tests::header_of(mesh);
        header.error = 1e-3;
        sink->begin(header);
        for (std::size_t i = 0; i < mesh.positions.size(); i += piece) {
            const std::size_t n = std::min(piece, mesh.positions.size() - i);
            sink->add_vertices({std::span(mesh.positions).subspan(i, n),
                                std::span(mesh.normals).subspan(i, n),
                                std::span(mesh.colors).subspan(i, n)});
        }
        for (std::size_t i = 0; i < mesh.triangles.size(); i += piece) {
            const std::size_t n = std::min(piece, mesh.triangles.size() - i);
            sink->add_triangles(std::span(mesh.triangles).subspan(i, n));
        }
        sink->finish();
        std::string bytes;
        for (const char* extension : {GetParam().extension, ".bin"}) {
            const auto part = folder.path() / (std::string("out") + extension);
            if (std::filesystem::exists(part)) bytes += tests::read_whole(part);
        }
        files.push_back(bytes);
    }
    EXPECT_TRUE(files[0] == files[1]);
    EXPECT_TRUE(files[0] == files[2]);
}

TEST(OutputOptions, ThatAFormatHasNotAreRefusedBeforeAnyWork) {
    const test::TempDir folder;
    const auto refused = [&](const char* name, const MeshFileOptions& options) {
        EXPECT_THROW((void)create_mesh_file(folder.path() / name, options), InvalidArgument)
            << name;
        EXPECT_EQ(folder.n_entries(), 0U);
    };
    refused("a.obj", {.is_ascii = true});
    refused("a.ply", {.quantization = kAuto});
    refused("a.ply", {.compression = Compression::Draco});
    refused("a.drc", {.compression = Compression::Draco});
    refused("a.glb", {.quantization = {Quantization::Kind::Bits, 17}});
    refused("a.glb", {.quantization = {Quantization::Kind::Step, 0}});
    refused("a.drc", {.quantization = {Quantization::Kind::Bits, 31}});
}

TEST(OutputOptions, AStepThat16BitsCannotReachLeavesFloats) {
    const test::TempDir folder;
    const Mesh mesh = tests::wavy_sheet(10, 100, {0, 0, 0});
    for (const double step : {1e-9, 1e-2}) {
        const auto path = folder.path() / "a.glb";
        const auto sink = create_mesh_file(
            path, {.overwrite = true, .quantization = {Quantization::Kind::Step, step}});
        tests::pour(mesh, *sink);
        EXPECT_EQ(sink->displacement() > 0, step > 1e-6);
        EXPECT_LE(sink->displacement(), step);
        EXPECT_EQ(open_mesh(path)->info().n_vertices, 100U);
    }
}

TEST(OutputOptions, TellWhatCompressionHolds) {
    const test::TempDir folder;
    SinkHeader header;
    header.n_vertices = 1'000'000;
    header.n_triangles = 2'000'000;
    EXPECT_EQ(create_mesh_file(folder.path() / "a.glb")->held_bytes(header), 0U);
    for (const auto compression : {Compression::Meshopt, Compression::Draco}) {
        EXPECT_GT(create_mesh_file(folder.path() / "a.glb", {.compression = compression})
                      ->held_bytes(header),
                  36'000'000U);
    }
}

TEST(GltfFiles, DocumentAndBufferComeAndGoTogether) {
    const test::TempDir folder;
    const Mesh mesh = tests::wavy_sheet(10, 1, {0, 0, 0});
    {
        const auto sink = create_mesh_file(folder.path() / "a b.gltf");
        sink->begin(tests::header_of(mesh));
    }
    EXPECT_EQ(folder.n_entries(), 0U);
    tests::pour(mesh, *create_mesh_file(folder.path() / "a b.gltf"));
    EXPECT_EQ(folder.n_entries(), 2U);
    EXPECT_NE(tests::read_whole(folder.path() / "a b.gltf").find("\"a%20b.bin\""),
              std::string::npos);
    EXPECT_EQ(open_mesh(folder.path() / "a b.gltf")->info().n_faces, mesh.triangles.size());
    // The buffer of another document is not replaced unasked.
    EXPECT_THROW((void)create_mesh_file(folder.path() / "a b.gltf"), IoError);
    std::filesystem::remove(folder.path() / "a b.gltf");
    EXPECT_THROW((void)create_mesh_file(folder.path() / "a b.gltf"), IoError);
}

TEST(OffFiles, HaveTheColumnsThatTheirFirstWordSays) {
    const test::TempDir folder;
    Mesh mesh = tests::wavy_sheet(3, 1, {0, 0, 0}, 0x8080);
    const auto first_lines = [&] {
        const auto path = folder.path() / "a.off";
        tests::pour(mesh, *create_mesh_file(path, {.overwrite = true}));
        const std::string text = tests::read_whole(path);
        const std::size_t counts = text.find("\n9 8 0\n");
        EXPECT_NE(counts, std::string::npos) << text;
        const std::size_t vertex = counts + 7;
        return text.substr(0, text.find('\n')) + "|" +
               text.substr(vertex, text.find('\n', vertex) - vertex);
    };
    EXPECT_EQ(first_lines().substr(0, 12), "CNOFF|0 0 0 ");
    mesh.normals.clear();
    EXPECT_EQ(first_lines(), "COFF|0 0 0 0 1 255 128");
    mesh.colors.clear();
    EXPECT_EQ(first_lines(), "OFF|0 0 0");
}

}  // namespace
}  // namespace hewer
