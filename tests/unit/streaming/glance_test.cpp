// SPDX-License-Identifier: MIT
/// What info() tells of large files without reading them through.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "hewer/info.h"
#include "hewer/mesh_sink.h"
#include "tests/support/packed.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"
#include "tests/unit/streaming/sample_mesh.h"

namespace hewer {
namespace {

using Basis = InputReport::Basis;

/// As if the file were large.
InputReport glance_at(const InputPaths& input) {
    InfoOptions options;
    options.whole_below = 0;
    return info(input, options);
}

std::filesystem::path write(const test::TempDir& dir, const std::string& name,
                            const MeshFileOptions& options = {}) {
    const std::filesystem::path path = dir.path() / name;
    const auto sink = create_mesh_file(path, options);
    tests::pour(tests::wavy_sheet(60, 10, {1, 2, 3}), *sink);
    return path;
}

TEST(Glance, tells_counts_and_attributes_by_the_header) {
    const test::TempDir dir;
    for (const char* const name : {"a.ply", "a.off", "a.glb", "a.gltf", "a.drc"}) {
        SCOPED_TRACE(name);
        const auto path = write(dir, name);
        const InputReport whole = info(path);
        const InputReport header = glance_at(path);
        EXPECT_EQ(whole.basis, Basis::Whole);
        EXPECT_EQ(header.basis, Basis::Header);
        EXPECT_EQ(header.format, whole.format);
        EXPECT_EQ(header.bytes, whole.bytes);
        EXPECT_EQ(header.vertices, whole.vertices);
        EXPECT_EQ(header.faces, whole.faces);
        if (path.extension() == ".drc") continue;  // the header does not tell the rest
        EXPECT_EQ(header.has_normals, whole.has_normals);
        EXPECT_EQ(header.has_colors, whole.has_colors);
    }
}

TEST(Glance, does_not_read_the_data) {
    const test::TempDir dir;
    for (const char* const name : {"a.ply", "a.glb"}) {
        const auto path = write(dir, name);
        const InputReport before = glance_at(path);
        // Zeros where triangles were.
        const auto size = std::filesystem::file_size(path);
        std::filesystem::resize_file(path, size / 2);
        std::filesystem::resize_file(path, size);
        EXPECT_EQ(glance_at(path).faces, before.faces);
    }
}

TEST(Glance, takes_boxes_from_gltf_and_samples_of_others) {
    const test::TempDir dir;
    for (const char* const name : {"a.ply", "a.stl", "a.glb"}) {
        const auto path = write(dir, name);
        EXPECT_EQ(glance_at(path).bounds.min, info(path).bounds.min) << name;
        EXPECT_EQ(glance_at(path).bounds.max, info(path).bounds.max) << name;
    }
    EXPECT_TRUE(glance_at(write(dir, "a.off")).bounds.is_empty());
}

TEST(Glance, estimates_text_from_a_sample) {
    const test::TempDir dir;
    // Twenty MB of text, of which 8 are looked at.
    const Mesh mesh = tests::wavy_sheet(400, 10, {0, 0, 0});
    const std::filesystem::path obj = dir.path() / "a.obj";
    const auto sink = create_mesh_file(obj);
    tests::pour(mesh, *sink);
    const InputReport sample = glance_at(obj);
    EXPECT_EQ(sample.basis, Basis::Sample);
    EXPECT_NEAR(static_cast<double>(sample.vertices), 160000, 3200);
    EXPECT_NEAR(static_cast<double>(sample.triangles), 2 * 399 * 399, 6400);
    EXPECT_TRUE(sample.has_normals);
    EXPECT_TRUE(sample.has_colors);
    EXPECT_NEAR(sample.bounds.max[0], 10, 0.2);

    std::string facet =
        "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n"
        "  vertex 0 1 0\n endloop\nendfacet\n";
    std::string text = "solid a\n";
    for (int i = 0; i < 100'000; ++i) text += facet;
    const InputReport stl = glance_at(dir.write("a.stl", text + "endsolid a\n"));
    EXPECT_EQ(stl.basis, Basis::Sample);
    EXPECT_NEAR(static_cast<double>(stl.faces), 1e5, 1e3);
}

TEST(Glance, unpacks_only_the_beginning) {
    const test::TempDir dir;
    const auto plain = write(dir, "a.ply");
    std::string content(std::filesystem::file_size(plain), '\0');
    std::ifstream(plain, std::ios::binary).read(content.data(), static_cast<long>(content.size()));
    const InputReport packed = glance_at(dir.write("a.ply.gz", test::gzip(content)));
    EXPECT_EQ(packed.basis, Basis::Header);
    EXPECT_EQ(packed.vertices, 3600U);
    EXPECT_EQ(packed.format, "PLY, binary little endian, gzip");
    const InputReport obj = glance_at(dir.write("a.obj.gz", test::gzip("v 0 0 0\nv 1 0 0\n")));
    EXPECT_EQ(obj.basis, Basis::Name);
    EXPECT_EQ(obj.format, "OBJ, gzip");
}

TEST(Glance, adds_up_several_files) {
    const test::TempDir dir;
    const InputReport both = glance_at(InputPaths({write(dir, "a.ply"), write(dir, "b.ply")}));
    EXPECT_EQ(both.vertices, 7200U);
    EXPECT_EQ(both.format, "PLY, binary little endian, 2 files");
    EXPECT_EQ(both.bounds.min[0], 1);
}

TEST(Glance, is_for_inputs_above_the_limit_only) {
    const test::TempDir dir;
    const auto path = write(dir, "a.ply");
    InfoOptions options;
    options.whole_below = std::filesystem::file_size(path);
    EXPECT_EQ(info(path, options).basis, Basis::Whole);
    --options.whole_below;
    EXPECT_EQ(info(path, options).basis, Basis::Header);
    options.with_topology = true;
    EXPECT_EQ(info(path, options).basis, Basis::Whole);
}

}  // namespace
}  // namespace hewer
