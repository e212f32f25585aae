// SPDX-License-Identifier: MIT
/// From paths to a source: compressed files, pipes, folders, patterns, several files as one model.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/packed.h"
#include "tests/support/ply_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

using test::gzip;
using test::zstd;

test::PlyMesh strip_of(std::size_t n, double x0) {
    test::PlyMesh mesh;
    for (std::size_t i = 0; i < n + 2; ++i) {
        const double x = x0 + static_cast<double>(i);
        mesh.positions.push_back({x, static_cast<double>(i % 2), 0});
    }
    for (std::size_t i = 0; i < n; ++i) {
        const auto a = static_cast<std::int64_t>(i);
        mesh.faces.push_back({a, a + 1, a + 2});
    }
    return mesh;
}

/// Reads `path` and expects the mesh of `text`, a PLY file.
void expect_same_mesh(const InputPaths& inputs, const std::string& text) {
    const test::TempDir dir;
    const auto expected = open_mesh(dir.write("plain.ply", text));
    const auto source = open_mesh(inputs);
    const test::ReadBack a = test::read_all(*source, 2);
    const test::ReadBack b = test::read_all(*expected, 1);
    EXPECT_EQ(a.mesh.positions, b.mesh.positions);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
    EXPECT_EQ(source->info().format, expected->info().format);
}

std::string refusal(const InputPaths& inputs, const OpenOptions& options = {}) {
    try {
        (void)open_mesh(inputs, options);
    } catch (const Error& e) {
        return e.what();
    }
    ADD_FAILURE() << "was not refused";
    return {};
}

TEST(CompressedInput, IsReadAsWhatIsInside) {
    const test::TempDir dir;
    const std::string binary = test::ply_file(strip_of(70000, 0));
    const std::string ascii = test::ply_file(strip_of(500, 0), {.format = "ascii"});
    for (const std::string& text : {binary, ascii}) {
        expect_same_mesh(dir.write("a", gzip(text)), text);
        expect_same_mesh(dir.write("b", zstd(text)), text);
    }
}

TEST(CompressedInput, MayConsistOfSeveralMembersOrFrames) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(3000, 0));
    const std::string head = text.substr(0, 1000);
    const std::string tail = text.substr(1000);
    expect_same_mesh(dir.write("a", gzip(head) + gzip(tail)), text);
    expect_same_mesh(dir.write("b", gzip(text) + std::string(512, '\0')), text);
    expect_same_mesh(dir.write("c", zstd(head) + zstd(tail, 19)), text);
}

TEST(CompressedInput, MayHaveSomethingElseBehindIt) {
    const test::TempDir dir;
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto path = dir.write("a", gzip(text) + "something else\n");
    std::vector<std::string> warnings;
    Hooks hooks;
    hooks.on_warning = [&](const std::string& warning) { warnings.push_back(warning); };
    EXPECT_EQ(open_mesh(path, {}, hooks)->info().n_faces, 1U);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("is not read"), std::string::npos) << warnings[0];
    EXPECT_NE(refusal(path, {.strict = true}).find("strict"), std::string::npos);
}

TEST(CompressedInput, ThatIsCutShortOrDamagedIsRefusedWithItsPlace) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(3000, 0));
    for (const std::string& packed : {gzip(text), zstd(text)}) {
        const auto cut = dir.write("cut", packed.substr(0, packed.size() / 2));
        EXPECT_NE(refusal(cut).find("cut: byte " + std::to_string(packed.size() / 2)),
                  std::string::npos)
            << refusal(cut);
        std::string damaged = packed;
        for (std::size_t i = packed.size() / 2; i < packed.size() / 2 + 40; ++i) damaged[i] ^= 0x5a;
        EXPECT_NE(refusal(dir.write("bad", damaged)).find("damaged"), std::string::npos);
    }
}

TEST(CompressedInput, KeepsToTheLimitsAndSaysWhichOne) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(70000, 0));
    const auto packed = dir.write("a", zstd(text));
    EXPECT_THROW((void)open_mesh(packed, {.max_temp_bytes = 100000}), OutOfDiskBudget);
    EXPECT_NE(refusal(packed, {.max_temp_bytes = 100000}).find("--max-temp"), std::string::npos);
    EXPECT_THROW((void)open_mesh(packed, {.memory_bytes = 17 << 20}), OutOfMemoryBudget);
}

TEST(CompressedInput, AsksForItsWindowBeforeItIsMade) {
    const test::TempDir dir;
    // The header of a frame with a window of 1 GiB, and a block of one byte.
    const std::string large("\x28\xb5\x2f\xfd\x00\xa0\x09\x00\x00v", 10);
    const auto path = dir.write("a", large);
    EXPECT_THROW((void)open_mesh(path, {.memory_bytes = 512 << 20}), OutOfMemoryBudget);
    EXPECT_NE(refusal(path, {.memory_bytes = 512 << 20}).find("raise --memory"), std::string::npos);
    // Where it fits, the content is what is wrong.
    EXPECT_THROW((void)open_mesh(path, {.memory_bytes = std::uint64_t{8} << 30}), FormatError);
}

TEST(CompressedInput, CountsTheUnpackedBytesAsItsOwn) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(7000, 0));
    EXPECT_EQ(open_mesh(dir.write("a", gzip(text)))->held_temp_bytes(), text.size());
    EXPECT_EQ(open_mesh(dir.write("b", text))->held_temp_bytes(), 0U);
}

TEST(CompressedInput, InsideCompressedInputIsRefused) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(70, 0));
    EXPECT_NE(refusal(dir.write("a", gzip(zstd(text)))).find("twice"), std::string::npos);
}

TEST(PipedInput, IsReadToItsEnd) {
    const test::TempDir dir;
    const std::string text = test::ply_file(strip_of(70000, 0));
    const auto pipe = dir.path() / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << text; });
    const auto source = open_mesh(pipe);
    writer.join();
    EXPECT_EQ(test::read_all(*source, 2).mesh.triangles.size(), 70000U);
    EXPECT_EQ(source->held_temp_bytes(), text.size());
}

TEST(SeveralInputs, AreOneModelInOrder) {
    const test::TempDir dir;
    const auto a = dir.write("tile_a.ply", test::ply_file(strip_of(20000, 0)));
    const auto b =
        dir.write("tile_b.ply", test::ply_file(strip_of(50000, 50), {.format = "ascii"}));
    const auto other = dir.write("readme.txt", "no mesh");
    const test::ReadBack first = test::read_all(*open_mesh(a), 1);
    const test::ReadBack second = test::read_all(*open_mesh(b), 1);
    const InputPaths listed(std::vector<std::filesystem::path>{a, b});
    for (const InputPaths& inputs :
         {listed, InputPaths(dir.path()), InputPaths(dir.path() / "tile_?.ply")}) {
        const auto source = open_mesh(inputs);
        EXPECT_EQ(source->info().n_vertices, 70004U);
        EXPECT_EQ(source->info().n_faces, 70000U);
        for (const unsigned n_threads : {1U, 4U}) {
            const test::ReadBack all = test::read_all(*source, n_threads);
            ASSERT_EQ(all.mesh.positions.size(), 70004U);
            EXPECT_TRUE(std::equal(first.mesh.positions.begin(), first.mesh.positions.end(),
                                   all.mesh.positions.begin()));
            ASSERT_EQ(all.mesh.triangles.size(), 70000U);
            EXPECT_EQ(all.mesh.triangles[19999], first.mesh.triangles[19999]);
            const Triangle& t = second.mesh.triangles[49999];
            EXPECT_EQ(all.mesh.triangles[69999],
                      (Triangle{t[0] + 20002, t[1] + 20002, t[2] + 20002}));
        }
    }
}

TEST(SeveralInputs, GiveAnyRangeOfVertices) {
    const test::TempDir dir;
    std::vector<std::filesystem::path> files;
    for (const std::size_t n : {3U, 1U, 40U}) {
        files.push_back(dir.write(std::to_string(n) + ".ply",
                                  test::ply_file(strip_of(n, 100.0 * static_cast<double>(n)))));
    }
    const auto source = open_mesh(files);
    const test::ReadBack all = test::read_all(*source, 1);
    ASSERT_TRUE(source->can_seek_vertices());
    source->begin_vertices();
    VertexBatch batch;
    const std::uint64_t n = source->info().n_vertices;
    for (std::uint64_t first = 0; first < n; ++first) {
        for (std::uint64_t last = first + 1; last <= n; ++last) {
            source->read_vertices(first, last - first, batch);
            ASSERT_EQ(batch.first, first);
            ASSERT_EQ(batch.positions.size(), last - first);
            for (std::uint64_t v = first; v < last; ++v) {
                ASSERT_EQ(batch.positions[v - first], all.mesh.positions[v]);
            }
        }
    }
}

TEST(SeveralInputs, WithAndWithoutColoursAndIndicesGoTogether) {
    const test::TempDir dir;
    test::PlyMesh red = strip_of(2, 0);
    red.colors.assign(4, {255, 0, 0, 255});
    const auto a = dir.write("a.ply", test::ply_file(red));
    const auto b = dir.write("b.ply", test::ply_file(strip_of(1, 0)));
    const auto c = dir.write("c.stl", test::stl_file({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, 1));
    const auto source = open_mesh(std::vector<std::filesystem::path>{a, b, c});
    EXPECT_TRUE(source->info().is_indexed);
    const test::ReadBack all = test::read_all(*source, 1);
    ASSERT_EQ(all.mesh.colors.size(), 10U);
    EXPECT_EQ(all.mesh.colors[0], (Rgba16{65535, 0, 0, 65535}));
    EXPECT_EQ(all.mesh.colors[9], (Rgba16{65535, 65535, 65535, 65535}));
    EXPECT_EQ(all.mesh.triangles.back(), (Triangle{7, 8, 9}));
    const auto soups = open_mesh(std::vector<std::filesystem::path>{c, c});
    EXPECT_FALSE(soups->info().is_indexed);
    EXPECT_EQ(test::read_all(*soups, 1).soup.size(), 2U);
}

TEST(SeveralInputs, ThatMatchNothingAreRefused) {
    const test::TempDir dir;
    EXPECT_THROW((void)open_mesh(dir.path() / "*.ply"), IoError);
    EXPECT_THROW((void)open_mesh(dir.path()), IoError);
    EXPECT_THROW((void)open_mesh(std::vector<std::filesystem::path>{}), InvalidArgument);
}

TEST(NamedFormat, DecidesWhatTheContentDoesNotTell) {
    const test::TempDir dir;
    const auto stl = dir.write("x", test::stl_file({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, 7,
                                                   std::string("\x01\x02 binary")));
    EXPECT_NE(refusal(stl).find("not a mesh file"), std::string::npos);
    EXPECT_EQ(open_mesh(stl, {.format = "stl"})->info().n_faces, 1U);
    EXPECT_THROW((void)open_mesh(stl, {.format = "doc"}), InvalidArgument);
}

/// Three vertices with a number each, whose name is `quality`.
std::string weighed_ply(const std::string& format, const std::string& type,
                        const std::array<double, 3>& weights) {
    std::string file = "ply\nformat " + format +
                       " 1.0\nelement vertex 3\nproperty float x\nproperty " + type +
                       " quality\nproperty float y\nproperty float z\nelement face 1\n"
                       "property list uchar int vertex_indices\nend_header\n";
    const auto put = [&](const std::string& of, double value) {
        file += test::ply_value(format, of, value);
        if (format == "ascii") file += ' ';
    };
    for (std::size_t v = 0; v < 3; ++v) {
        put("float", v == 1 ? 1 : 0);
        put(type, weights[v]);
        put("float", v == 2 ? 1 : 0);
        put("float", 0);
    }
    put("uchar", 3);
    for (const double id : {0.0, 1.0, 2.0}) put("int", id);
    return file;
}

std::vector<float> weights_of(MeshSource& source) {
    std::vector<float> weights;
    source.begin_vertices();
    for (VertexBatch batch; source.next_vertices(batch);) {
        weights.insert(weights.end(), batch.weights.begin(), batch.weights.end());
    }
    return weights;
}

TEST(WeightProperty, IsAnyNumberOfThePlyVertices) {
    const test::TempDir dir;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        for (const char* type : {"float", "double", "uchar", "int"}) {
            const auto path = dir.write("a.ply", weighed_ply(format, type, {3, 0, 7}));
            const auto source = open_mesh(path, {.weight_property = "quality"});
            EXPECT_TRUE(source->info().has_weights);
            EXPECT_TRUE(source->info().ignored.empty());
            EXPECT_EQ(weights_of(*source), (std::vector<float>{3, 0, 7})) << format << type;
            const auto plain = open_mesh(path);
            EXPECT_FALSE(plain->info().has_weights);
            EXPECT_TRUE(weights_of(*plain).empty());
        }
    }
}

TEST(WeightProperty, IsReadFromEachOfSeveralFiles) {
    const test::TempDir dir;
    const auto a = dir.write("a.ply", weighed_ply("ascii", "float", {1, 2, 3}));
    const auto b = dir.write("b.ply", weighed_ply("binary_little_endian", "float", {4, 5, 6}));
    const auto source =
        open_mesh(std::vector<std::filesystem::path>{a, b}, {.weight_property = "quality"});
    EXPECT_EQ(weights_of(*source), (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

TEST(WeightProperty, ThatIsNotThereIsRefusedWithTheNamesOfThoseThatAre) {
    const test::TempDir dir;
    const auto path = dir.write("a.ply", weighed_ply("ascii", "float", {1, 2, 3}));
    const std::string why = refusal(path, {.weight_property = "confidence"});
    EXPECT_NE(why.find("'confidence'"), std::string::npos) << why;
    EXPECT_NE(why.find("x, quality, y, z"), std::string::npos) << why;
}

TEST(WeightProperty, OfAnotherFormatIsRefused) {
    const test::TempDir dir;
    const auto path = dir.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string why = refusal(path, {.weight_property = "quality"});
    EXPECT_NE(why.find("needs a PLY or glTF"), std::string::npos) << why;
}

}  // namespace
}  // namespace hewer
