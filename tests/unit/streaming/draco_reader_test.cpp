// SPDX-License-Identifier: MIT
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <draco/point_cloud/point_cloud_builder.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "hewer/error.h"
#include "hewer/info.h"
#include "hewer/mesh_source.h"
#include "tests/support/glb_builder.h"
#include "tests/support/read_back.h"
#include "tests/support/temp_dir.h"

namespace hewer {
namespace {

struct Encoded {
    std::string bytes;
    std::uint32_t position_id = 0;
    std::uint32_t color_id = 0;
};

/// A bent grid of n x n squares, with colours; 14 bits of position, or all.
Encoded encode_grid(int n, bool is_sequential, bool has_colors, bool is_exact = false,
                    bool has_metadata = false) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2 * n * n);
    const int positions =
        builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int colors =
        has_colors ? builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, true)
                   : -1;
    const auto point = [](int i, int k) {
        return std::array<float, 3>{static_cast<float>(i), static_cast<float>(k),
                                    static_cast<float>(i * k) * 0.125F};
    };
    const auto color = [](int i, int k) {
        return std::array<std::uint8_t, 3>{static_cast<std::uint8_t>(i),
                                           static_cast<std::uint8_t>(k), 7};
    };
    int face = 0;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            for (const bool is_upper : {false, true}) {
                const std::array<std::array<int, 2>, 3> c =
                    is_upper ? std::array<std::array<int, 2>, 3>{{{i + 1, k},
                                                                  {i + 1, k + 1},
                                                                  {i, k + 1}}}
                             : std::array<std::array<int, 2>, 3>{{{i, k}, {i + 1, k}, {i, k + 1}}};
                const draco::FaceIndex f(static_cast<std::uint32_t>(face++));
                builder.SetAttributeValuesForFace(positions, f, point(c[0][0], c[0][1]).data(),
                                                  point(c[1][0], c[1][1]).data(),
                                                  point(c[2][0], c[2][1]).data());
                if (!has_colors) continue;
                builder.SetAttributeValuesForFace(colors, f, color(c[0][0], c[0][1]).data(),
                                                  color(c[1][0], c[1][1]).data(),
                                                  color(c[2][0], c[2][1]).data());
            }
        }
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    if (has_metadata) {
        auto metadata = std::make_unique<draco::GeometryMetadata>();
        metadata->AddEntryString("name", "grid");
        auto nested = std::make_unique<draco::Metadata>();
        nested->AddEntryInt("seven", 7);
        metadata->AddSubMetadata("more", std::move(nested));
        auto of_attribute = std::make_unique<draco::AttributeMetadata>();
        of_attribute->AddEntryString("name", std::string(300, 'x'));
        mesh->AddMetadata(std::move(metadata));
        mesh->AddAttributeMetadata(positions, std::move(of_attribute));
    }
    draco::Encoder encoder;
    encoder.SetEncodingMethod(is_sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                            : draco::MESH_EDGEBREAKER_ENCODING);
    if (!is_exact) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    Encoded encoded{{buffer.data(), buffer.size()}, 0, 0};
    encoded.position_id = mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION)->unique_id();
    if (has_colors) {
        encoded.color_id = mesh->GetNamedAttribute(draco::GeometryAttribute::COLOR)->unique_id();
    }
    return encoded;
}

TEST(DracoReader, DecodesBothMethodsToArraysOnDisk) {
    const test::TempDir dir;
    for (const bool is_sequential : {false, true}) {
        const auto source =
            open_mesh(dir.write("a.drc", encode_grid(40, is_sequential, true, true).bytes));
        EXPECT_EQ(source->info().format, "Draco");
        EXPECT_EQ(source->info().n_vertices, 41U * 41U);
        EXPECT_EQ(source->info().n_faces, 3200U);
        EXPECT_GT(source->held_temp_bytes(), 3200U * 12);
        const test::ReadBack back = test::read_all(*source, 2);
        ASSERT_EQ(back.mesh.colors.size(), back.mesh.positions.size());
        EXPECT_EQ(back.mesh.triangles.size(), 3200U);
        for (std::size_t v = 0; v < back.mesh.positions.size(); ++v) {
            const Vec3& p = back.mesh.positions[v];
            EXPECT_EQ(p[2], p[0] * p[1] * 0.125);
            EXPECT_EQ(back.mesh.colors[v],
                      (Rgba16{static_cast<std::uint16_t>(257 * p[0]),
                              static_cast<std::uint16_t>(257 * p[1]), 7 * 257, 65535}));
        }
    }
}

TEST(DracoReader, ReadsCompressedPrimitivesOfGltf) {
    const test::TempDir dir;
    const Encoded encoded = encode_grid(10, false, true);
    test::GlbBuilder glb;
    const auto view = glb.add_view(encoded.bytes);
    glb.document["accessors"] = {{{"count", 121}, {"componentType", 5126}, {"type", "VEC3"}}};
    glb.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    glb.document["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", 0}}},
            {"extensions",
             {{"KHR_draco_mesh_compression",
               {{"bufferView", view}, {"attributes", {{"POSITION", encoded.position_id}}}}}}}}}}}};
    glb.document["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {100, 0, 0}}}};
    const auto source = open_mesh(dir.write("a.glb", glb.glb()));
    const test::ReadBack back = test::read_all(*source);
    EXPECT_EQ(back.mesh.triangles.size(), 400U);
    EXPECT_EQ(back.mesh.positions.size(), 242U);
    EXPECT_NEAR(back.mesh.positions[121][0], back.mesh.positions[0][0] + 100, 1e-4);
}

TEST(DracoReader, RefusesPointCloudsAndDamage) {
    const test::TempDir dir;
    draco::PointCloudBuilder builder;
    builder.Start(3);
    const int attribute =
        builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const std::array<float, 9> points{0, 0, 0, 1, 0, 0, 0, 1, 0};
    builder.SetAttributeValuesForAllPoints(attribute, points.data(), 12);
    const auto cloud = builder.Finalize(false);
    draco::EncoderBuffer buffer;
    draco::Encoder encoder;
    ASSERT_TRUE(encoder.EncodePointCloudToBuffer(*cloud, &buffer).ok());
    try {
        (void)open_mesh(dir.write("cloud.drc", {buffer.data(), buffer.size()}));
        FAIL();
    } catch (const FormatError& e) {
        EXPECT_NE(std::string(e.what()).find("point cloud"), std::string::npos);
    }
    const std::string whole = encode_grid(20, false, false).bytes;
    for (const std::size_t n : {std::size_t{6}, std::size_t{20}, whole.size() / 2}) {
        EXPECT_THROW((void)open_mesh(dir.write("cut.drc", whole.substr(0, n))), FormatError);
    }
}

TEST(DracoReader, ChecksTheLimitBeforeItDecodes) {
    const test::TempDir dir;
    const auto path = dir.write("a.drc", encode_grid(400, false, false).bytes);
    try {
        (void)open_mesh(path, {.memory_bytes = 40 << 20});
        FAIL();
    } catch (const OutOfMemoryBudget& e) {
        const std::string what = e.what();
        const std::size_t at = what.find("raise --memory to ");
        ASSERT_NE(at, std::string::npos) << what;
        // The number that it names will do.
        const std::uint64_t mib = std::stoull(what.substr(at + 18));
        EXPECT_NO_THROW((void)open_mesh(path, {.memory_bytes = mib << 20}));
    }
    EXPECT_THROW((void)open_mesh(path, {.max_temp_bytes = 1 << 20}), OutOfDiskBudget);
}

TEST(DracoReader, TellsTheCountsOfTheHeaderBehindAnyMetadata) {
    const test::TempDir dir;
    for (const bool is_sequential : {false, true}) {
        for (const bool has_metadata : {false, true}) {
            const auto path =
                dir.write("a.drc", encode_grid(30, is_sequential, true, false, has_metadata).bytes);
            const InputReport report = info(path, {.whole_below = 0});
            EXPECT_EQ(report.basis, InputReport::Basis::Header);
            EXPECT_EQ(report.vertices, 31U * 31U);
            EXPECT_EQ(report.faces, 1800U);
        }
    }
}

TEST(DracoReader, ChecksTheLimitForOldVersionsToo) {
    // Versions below 2.0 have counts of four bytes: 2^24 vertices and faces here.
    const test::TempDir dir;
    std::string file = "DRACO";
    file += std::string("\x01\x01\x01\x01\x00\x00\x00", 7);
    for (int i = 0; i < 6; ++i) file += std::string("\x00\x00\x00\x01", 4);
    EXPECT_THROW((void)open_mesh(dir.write("a.drc", file), {.memory_bytes = 64 << 20}),
                 OutOfMemoryBudget);
}

TEST(DracoReader, SurvivesMutatedFiles) {
    const test::TempDir dir;
    std::mt19937 random(4);
    for (const bool is_sequential : {false, true}) {
        const std::string whole = encode_grid(6, is_sequential, true).bytes;
        for (int round = 0; round < 500; ++round) {
            std::string file = whole;
            for (std::size_t n = 1 + random() % 3; n > 0; --n) {
                file[5 + random() % (file.size() - 5)] = static_cast<char>(random());
            }
            try {
                const auto source = open_mesh(dir.write("a.drc", file), {.memory_bytes = 64 << 20});
                (void)test::read_all(*source);
            } catch (const Error& e) {
                EXPECT_NE(std::string(e.what()), "");
            }
        }
    }
}

}  // namespace
}  // namespace hewer
