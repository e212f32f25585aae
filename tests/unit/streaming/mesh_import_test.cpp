// SPDX-License-Identifier: MIT
#include "streaming/mesh_import.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "hewer/error.h"
#include "tests/support/read_back.h"

namespace hewer::streaming {
namespace {

MeshImport make_import(const OpenOptions& options = {}) {
    return {"model", "test", 1000, options, {}};
}

TEST(PackedTriangle, KeepsIdsBelowItsLimit) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        Triangle t{};
        for (std::uint64_t& v : t) v = random() % PackedTriangle::kMostVertices;
        EXPECT_EQ(PackedTriangle(t).unpack(), t);
    }
}

TEST(MeshImport, GivesBackWhatWasAddedOnAnyNumberOfThreads) {
    MeshImport import = make_import();
    Mesh mesh;
    std::mt19937_64 random(2);
    for (std::uint64_t v = 0; v < 100000; ++v) {
        const auto x = static_cast<float>(v);
        mesh.positions.push_back({x, -x, 0.5});
        mesh.normals.push_back({0, 0, x});
        mesh.colors.push_back({static_cast<std::uint16_t>(v), 1, 2, 65535});
    }
    for (int i = 0; i < 150000; ++i) {
        mesh.triangles.push_back({random() % 100000, random() % 100000, random() % 100000});
    }
    for (std::size_t first = 0; first < 100000; first += 1000) {
        import.add_vertices({std::span(mesh.positions).subspan(first, 1000),
                             std::span(mesh.normals).subspan(first, 1000),
                             std::span(mesh.colors).subspan(first, 1000)});
    }
    import.add_triangles(mesh.triangles);
    const auto source = import.finish();
    EXPECT_GT(source->held_temp_bytes(), 0U);
    EXPECT_LE(source->held_memory_bytes(), 1U << 20);
    for (const unsigned n_threads : {1U, 3U}) {
        const test::ReadBack back = test::read_all(*source, n_threads);
        EXPECT_EQ(back.mesh.positions, mesh.positions);
        EXPECT_EQ(back.mesh.normals, mesh.normals);
        EXPECT_EQ(back.mesh.colors, mesh.colors);
        EXPECT_EQ(back.mesh.triangles, mesh.triangles);
    }
}

TEST(MeshImport, FillsInAttributesThatBeginLateOrEndEarly) {
    MeshImport import = make_import();
    const std::vector<Vec3> two{{0, 0, 0}, {1, 0, 0}};
    const std::vector<Rgba16> colors{{1, 2, 3, 4}, {5, 6, 7, 8}};
    import.add_vertices({two, {}, {}});
    import.add_vertices({two, {}, colors});
    import.add_vertices({two, {}, {}});
    import.add_triangles(std::vector<Triangle>{{ 0, 1, 2 }});
    const auto source = import.finish();
    EXPECT_TRUE(source->info().has_colors);
    EXPECT_FALSE(source->info().has_alpha);
    EXPECT_FALSE(source->info().has_normals);
    const Rgba16 white{65535, 65535, 65535, 65535};
    EXPECT_EQ(test::read_all(*source, 1).mesh.colors,
              (std::vector<Rgba16>{white, white, colors[0], colors[1], white, white}));
}

TEST(MeshImport, CountsDirtOnceInEachPass) {
    MeshImport import = make_import();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    import.add_vertices({std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, { nan, 0, 0 }}, {}, {}});
    import.defects().short_faces = 5;
    import.add_triangles(std::vector<Triangle>{{0, 1, 2},
                                               {0, 1, 3},
                                               { 0,
                                                 1,
                                                 std::uint64_t{1} << 50 }});
    const auto source = import.finish();
    for (int pass = 0; pass < 2; ++pass) {
        const test::ReadBack back = test::read_all(*source, 2);
        EXPECT_EQ(back.defects.nonfinite_vertices, 1U);
        EXPECT_EQ(back.defects.first_nonfinite, "vertex 2");
        EXPECT_EQ(back.defects.short_faces, 5U);
        EXPECT_EQ(back.defects.out_of_range_triangles, 2U);
        EXPECT_EQ(back.defects.first_out_of_range, "face 1");
        EXPECT_EQ(back.mesh.triangles.size(), 1U);
    }
}

TEST(MeshImport, RefusesDirtInStrictMode) {
    MeshImport import = make_import({.strict = true});
    const double inf = std::numeric_limits<double>::infinity();
    EXPECT_THROW(import.add_vertices({std::vector<Vec3>{{inf, 0, 0}}, {}, {}}), FormatError);
    import.add_vertices({std::vector<Vec3>{{ 0, 0, 0 }}, {}, {}});
    import.add_triangles(std::vector<Triangle>{{ 0, 0, 7 }});
    const auto source = import.finish();
    EXPECT_THROW((void)test::read_all(*source, 1), FormatError);
}

TEST(MeshImport, DeliversDoublesOnlyWhereFloatsAreTooCoarse) {
    for (const double offset : {0.0, 5'000'000.0}) {
        MeshImport import = make_import();
        const std::vector<Vec3> positions{{offset, 0, 0}, {offset + 0.1, 0, 0}, {offset, 1, 0}};
        import.add_vertices({positions, {}, {}});
        import.add_triangles(std::vector<Triangle>{{ 0, 1, 2 }});
        const auto source = import.finish();
        EXPECT_EQ(source->info().has_double_positions, offset > 0);
        const double x = test::read_all(*source, 1).mesh.positions[1][0];
        EXPECT_EQ(x, offset > 0 ? offset + 0.1 : static_cast<double>(0.1F));
    }
}

TEST(MeshImport, OfASoupGivesPoints) {
    MeshImport import = make_import();
    const std::vector<std::array<Vec3, 3>> soup(40000, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    import.add_points(soup);
    const auto source = import.finish();
    EXPECT_FALSE(source->info().is_indexed);
    EXPECT_EQ(test::read_all(*source, 2).soup, soup);
}

TEST(MeshImport, WithoutTrianglesIsRefused) {
    MeshImport import = make_import();
    import.add_vertices({std::vector<Vec3>{{ 0, 0, 0 }}, {}, {}});
    try {
        (void)import.finish();
        FAIL();
    } catch (const FormatError& e) {
        EXPECT_NE(std::string(e.what()).find("point cloud"), std::string::npos);
    }
}

TEST(MeshImport, StopsAtTheLimitOfTemporaryFiles) {
    MeshImport import = make_import({.max_temp_bytes = 1 << 20});
    const std::vector<Vec3> positions(100000);
    EXPECT_THROW(import.add_vertices({positions, {}, {}}), OutOfDiskBudget);
}

}  // namespace
}  // namespace hewer::streaming
