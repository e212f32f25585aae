// SPDX-License-Identifier: MIT
/// OpenMesh's format, in files made byte by byte.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/read_back.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

template <typename T>
void put(std::string& to, T value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof value);
    to.append(bytes.data(), bytes.size());
}

// Headers of chunks: what they are of, what they hold, how it is stored.
constexpr std::uint16_t kPositions = 0x1600;        // three floats
constexpr std::uint16_t kDoublePositions = 0x5600;  // three doubles
constexpr std::uint16_t kHalfedges = 0x16f8;        // next, vertex, face: a signed byte each
constexpr std::uint16_t kFirstHalfedges = 0x06e8;   // of faces: a signed byte
constexpr std::uint16_t kFaceLists = 0x00e8;        // vertices of faces: a byte each
constexpr std::uint16_t kStatus = 0x0060;           // of vertices: 32 bits, whatever it says
constexpr std::uint16_t kNamed = 0x00c2;            // a property of vertices
constexpr std::uint16_t kEnd = 0x001c;

std::string header(char kind, unsigned major, unsigned minor, std::uint32_t n_vertices,
                   std::uint32_t n_faces, std::uint32_t n_edges) {
    std::string out = "OM";
    out += kind;
    out += static_cast<char>(major << 5 | minor);
    put(out, n_vertices);
    put(out, n_faces);
    put(out, n_edges);
    return out;
}

std::string positions(std::uint16_t chunk = kPositions) {
    std::string out;
    put(out, chunk);
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}) {
        for (const double x : p) {
            if (chunk == kPositions) {
                put(out, static_cast<float>(x));
            } else {
                put(out, x);
            }
        }
    }
    return out;
}

/// A square of two triangles, 0 1 2 and 0 2 3.
std::string halfedges() {
    std::string out;
    put(out, kHalfedges);
    for (const std::array<int, 3>& h :
         {std::array{2, 1, 0}, std::array{9, 0, -1}, std::array{4, 2, 0}, std::array{1, 1, -1},
          std::array{0, 0, 0}, std::array{6, 2, 1}, std::array{8, 3, 1}, std::array{3, 2, -1},
          std::array{5, 0, 1}, std::array{7, 3, -1}}) {
        for (const int x : h) put(out, static_cast<std::int8_t>(x));
    }
    put(out, kFirstHalfedges);
    out += '\x04';
    out += '\x08';
    return out;
}

std::string end() {
    std::string out;
    put(out, kEnd);
    return out;
}

Mesh read(const std::string& content) {
    const test::TempDir dir;
    return test::read_all(*open_mesh(dir.write("a.om", content))).mesh;
}

std::string refusal(const std::string& content, const OpenOptions& options = {}) {
    const test::TempDir dir;
    try {
        test::read_all(*open_mesh(dir.write("a.om", content), options));
    } catch (const Error& e) {
        return e.what();
    }
    ADD_FAILURE() << "was not refused";
    return {};
}

const std::set<Triangle> kSquare{{0, 1, 2}, {0, 2, 3}};

TEST(OmReader, walks_along_halfedges) {
    const Mesh mesh = read(header('T', 2, 2, 4, 2, 5) + positions() + halfedges() + end());
    EXPECT_EQ(mesh.positions[2], (Vec3{1, 1, 0}));
    EXPECT_EQ(test::triangle_set(mesh.triangles), kSquare);
}

TEST(OmReader, reads_lists_of_faces_of_older_versions) {
    std::string lists;
    put(lists, kFaceLists);
    for (const int v : {0, 1, 2, 0, 2, 3}) lists += static_cast<char>(v);
    const Mesh mesh = read(header('T', 1, 2, 4, 2, 0) + positions(kDoublePositions) + lists);
    EXPECT_EQ(mesh.positions[2], (Vec3{1, 1, 0}));
    EXPECT_EQ(test::triangle_set(mesh.triangles), kSquare);
    std::string polygon;
    put(polygon, kFaceLists);
    put(polygon, std::uint16_t{4});
    for (const int v : {0, 1, 2, 3}) polygon += static_cast<char>(v);
    EXPECT_EQ(
        test::triangle_set(read(header('P', 1, 2, 4, 1, 0) + positions() + polygon).triangles),
        kSquare);
}

TEST(OmReader, passes_over_what_it_does_not_carry_and_names_it) {
    std::string others;
    put(others, kStatus);
    others.append(4 * sizeof(std::uint32_t), '\0');
    put(others, kNamed);
    others += "\x07quality";
    others +=
        "\x06"
        "double";
    put(others, std::uint32_t{32});
    others.append(32, '\0');
    const test::TempDir dir;
    const auto source = open_mesh(
        dir.write("a.om", header('T', 2, 2, 4, 2, 5) + positions() + others + halfedges() + end()));
    EXPECT_EQ(source->info().format, "OpenMesh");
    EXPECT_EQ(source->info().ignored,
              (std::vector<std::string>{"status flags", "named properties"}));
    EXPECT_EQ(test::triangle_set(test::read_all(*source).mesh.triangles), kSquare);
}

TEST(OmReader, refuses_damage_with_its_place) {
    const std::string good = header('T', 2, 2, 4, 2, 5) + positions() + halfedges() + end();
    EXPECT_NE(refusal(good.substr(0, 40)).find("byte 16: truncated"), std::string::npos);
    // A chain that leads away, in a circle beside its face, or nowhere.
    const std::size_t first_next = header('T', 2, 2, 4, 2, 5).size() + positions().size() + 2;
    for (const char next : {'\x7f', '\x00', '\xff'}) {
        std::string bad = good;
        bad[first_next] = next;
        EXPECT_NE(refusal(bad).find("do not lead around it"), std::string::npos);
    }
    std::string many = good;
    many.replace(12, 4, "\xff\xff\xff\x7f");
    EXPECT_NE(refusal(many).find("truncated"), std::string::npos);
}

TEST(OmReader, counts_corners_that_are_no_vertices) {
    std::string bad = header('T', 2, 2, 4, 2, 5) + positions() + halfedges() + end();
    bad[header('T', 2, 2, 4, 2, 5).size() + positions().size() + 2 + 1] = '\x63';
    const test::TempDir dir;
    const test::ReadBack read = test::read_all(*open_mesh(dir.write("a.om", bad)));
    EXPECT_EQ(read.defects.out_of_range_triangles, 1U);
    EXPECT_EQ(read.mesh.triangles.size(), 1U);
}

TEST(OmReader, says_what_memory_would_do_for_the_halfedges) {
    // Ten million of them in a file without data, sparse on the disk.
    constexpr std::uint32_t kEdges = 5'000'000;
    const test::TempDir dir;
    std::string content = header('T', 2, 2, 4, 2, kEdges) + positions();
    put(content, std::uint16_t{0x96f8});  // 32 bits each
    const auto path = dir.write("a.om", content);
    std::filesystem::resize_file(path, content.size() + std::uint64_t{24} * kEdges);
    {
        std::ofstream out(path, std::ios::binary | std::ios::app);
        std::string faces;
        put(faces, kFirstHalfedges);
        out << faces << '\x04' << '\x08';
    }
    try {
        (void)open_mesh(path, {.memory_bytes = 64 << 20});
        ADD_FAILURE() << "was not refused";
    } catch (const OutOfMemoryBudget& e) {
        EXPECT_NE(std::string(e.what()).find("raise --memory to"), std::string::npos) << e.what();
    }
}

TEST(OmReader, survives_mutated_files) {
    const std::string good = header('P', 2, 2, 4, 2, 5) + positions() + halfedges() + end();
    test::Random random(5);
    const test::TempDir dir;
    for (int i = 0; i < 2000; ++i) {
        std::string bad = good;
        for (int k = 0; k < 2; ++k)
            bad[random.below(bad.size())] = static_cast<char>(random.next());
        if (random.below(4) == 0) bad.resize(random.below(bad.size()));
        const auto path = dir.write("a.om", bad);
        try {
            test::read_all(*open_mesh(path, {.format = "om", .memory_bytes = 64 << 20}));
        } catch (const Error&) {
        }
    }
}

}  // namespace
}  // namespace hewer
