// SPDX-License-Identifier: MIT
#include "streaming/topology_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/info.h"
#include "hewer/mesh_sink.h"
#include "streaming/topology_counter.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"

namespace hewer::streaming {

namespace {

std::vector<Mesh> shapes() {
    return {test::cube_sphere(9, 0.05),
            test::torus(30, 11),
            test::plane_grid(20, 0.02),
            test::book(5, 6),
            test::many_spheres(3, 3),
            test::moebius_strip(30, 3),
            test::joined(test::two_sheets(7, 0.1), test::torus(12, 5)),
            test::random_soup(60, 150, 1),
            test::random_soup(60, 1500, 2)};
}

std::uint64_t count_components(const Mesh& mesh) {
    std::vector<std::uint64_t> label(mesh.positions.size());
    for (std::uint64_t v = 0; v < label.size(); ++v) label[v] = v;
    std::vector<bool> is_used(label.size());
    for (bool is_changed = true; is_changed;) {
        is_changed = false;
        for (const Triangle& t : mesh.triangles) {
            const std::uint64_t least = std::min({label[t[0]], label[t[1]], label[t[2]]});
            for (const std::uint64_t v : t) {
                is_used[v] = true;
                is_changed |= label[v] != least;
                label[v] = least;
            }
        }
    }
    std::uint64_t n = 0;
    for (std::uint64_t v = 0; v < label.size(); ++v) n += is_used[v] && label[v] == v ? 1U : 0U;
    return n;
}

/// Without faces that have a repeated corner, which do not count.
Mesh without_degenerate(Mesh mesh) {
    std::erase_if(mesh.triangles,
                  [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[0] == t[2]; });
    return mesh;
}

void expect_topology(const TopologyReport& topology, const Mesh& mesh, const std::string& what) {
    const test::Counts counts = test::count(without_degenerate(mesh));
    EXPECT_EQ(topology.components, count_components(without_degenerate(mesh))) << what;
    EXPECT_EQ(topology.border_edges, counts.border_edges) << what;
    EXPECT_EQ(topology.border_loops, counts.border_loops) << what;
    EXPECT_EQ(topology.nonmanifold_edges, counts.nonmanifold_edges) << what;
    EXPECT_EQ(topology.nonmanifold_vertices, counts.nonmanifold_vertices) << what;
    EXPECT_EQ(topology.euler, counts.euler) << what;
}

std::filesystem::path write_mesh(const test::TempDir& dir, const std::string& name,
                                 const Mesh& mesh) {
    std::filesystem::path path = dir.path() / name;
    const auto sink = create_mesh_file(path);
    SinkHeader header;
    header.n_vertices = mesh.positions.size();
    header.n_triangles = mesh.triangles.size();
    header.bounds = test::bounds_of(mesh);
    sink->begin(header);
    sink->add_vertices({mesh.positions, {}, {}});
    sink->add_triangles(mesh.triangles);
    sink->finish();
    return path;
}

}  // namespace

TEST(TopologyScan, CountsAsBruteForceDoesInAnyOrderWithAnyMemory) {
    std::uint64_t seed = 0;
    for (const Mesh& mesh : shapes()) {
        for (const Mesh& m : {mesh, test::shuffled(mesh, ++seed)}) {
            for (const bool is_tight : {false, true}) {
                ooc::ResourceLimits limits{.memory_bytes = std::uint64_t{1} << 30, .n_threads = 3};
                if (is_tight) {
                    limits.memory_bytes = std::uint64_t{24} << 20;
                    limits.page_bytes = 4096;
                    limits.sort_bytes = 600;
                    limits.spills_at_once = true;
                }
                ooc::Context context(limits);
                const auto source = view_mesh(m);
                expect_topology(count_topology(context, *source), m,
                                "mesh " + std::to_string(seed));
            }
        }
    }
}

TEST(TopologyScan, EqualCornersOfASoupAreOneVertex) {
    const test::TempDir dir;
    std::size_t i = 0;
    for (const Mesh& mesh : shapes()) {
        // Powers of two and few bits: no two vertices meet when they are rounded.
        const Mesh rounded = test::rounded(mesh);
        const auto path = write_mesh(dir, std::to_string(i++) + ".stl", rounded);
        for (const std::uint64_t sort_bytes : {std::uint64_t{0}, std::uint64_t{900}}) {
            ooc::Context context(ooc::ResourceLimits{.memory_bytes = std::uint64_t{64} << 20,
                                                     .n_threads = 2,
                                                     .page_bytes = 8192,
                                                     .sort_bytes = sort_bytes});
            const auto source = open_mesh(path);
            ASSERT_FALSE(source->info().is_indexed);
            expect_topology(count_topology(context, *source), rounded,
                            "soup " + std::to_string(i - 1));
        }
    }
}

TEST(TopologyScan, MinusZeroIsZero) {
    const test::TempDir dir;
    Mesh mesh;
    mesh.positions = {{0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, -0.0, 0}, {-1, 0, 0}, {0, 1, -0.0}};
    mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
    InfoOptions options;
    options.with_topology = true;
    const InputReport report = info(write_mesh(dir, "zero.stl", mesh), options);
    ASSERT_TRUE(report.topology.has_value());
    EXPECT_EQ(report.topology->components, 1U);
    EXPECT_EQ(report.topology->border_edges, 4U);
    EXPECT_EQ(report.topology->border_loops, 1U);
    EXPECT_EQ(report.topology->euler, 1);
}

TEST(TopologyScan, IsThereOnlyWhenItWasAskedFor) {
    const test::TempDir dir;
    const auto path = write_mesh(dir, "sphere.ply", test::cube_sphere(8));
    EXPECT_FALSE(info(path).topology.has_value());
    EXPECT_EQ(info(path).triangle_passes, 1);
    InfoOptions options;
    options.with_topology = true;
    EXPECT_EQ(info(path, options).topology->euler, 2);
    EXPECT_EQ(info(path, options).triangle_passes, 2);
}

TEST(TopologyCounter, RefusesMoreVerticesThanMemoryHasRoomForByName) {
    ooc::Context context(ooc::ResourceLimits{.memory_bytes = std::uint64_t{24} << 20});
    try {
        const TopologyCounter counter(context, 5'000'000, 1 << 20);
        FAIL() << "20 MB fitted into 8 MiB";
    } catch (const OutOfMemoryBudget& e) {
        EXPECT_NE(std::string(e.what()).find("components of a surface"), std::string::npos)
            << e.what();
    }
}

TEST(TopologyCounter, AVertexOfVeryManyFacesIsOneVertex) {
    // A closed fan of 100 k faces, apex 0.
    constexpr std::uint64_t kFaces = 100'000;
    ooc::Context context(ooc::ResourceLimits{.memory_bytes = std::uint64_t{256} << 20});
    TopologyCounter counter(context, kFaces + 1, 1 << 16);
    std::vector<Triangle> faces;
    for (std::uint64_t i = 0; i < kFaces; ++i) {
        faces.push_back({0, 1 + i * 7919 % kFaces, 1 + (i * 7919 + 1) % kFaces});
    }
    counter.add(faces);
    const TopologyReport report = counter.finish();
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.border_edges, kFaces);
    EXPECT_EQ(report.border_loops, 1U);
    EXPECT_EQ(report.nonmanifold_vertices, 0U);
    EXPECT_EQ(report.euler, 1);
}

}  // namespace hewer::streaming
