// SPDX-License-Identifier: MIT
#include "rsimp/lod_output.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "ooc/vec3.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_dir.h"
#include "tests/unit/rsimp/stored_mesh.h"
#include "tests/unit/streaming/parsed_mesh.h"

namespace hewer::rsimp {
namespace {

/// Cells of size 1 at the origin, so that coordinates stay what they are but for rounding.
LodOutput::Format format_of(const Mesh& mesh) {
    Bounds box;
    box.extend(Vec3{0, 0, 0});
    box.extend(Vec3{64, 64, 64});
    return {cluster::Lattice(box), cluster::UniformGrid(64), !mesh.normals.empty(),
            !mesh.colors.empty(),  !mesh.colors.empty(),     true};
}

struct Written {
    Mesh mesh;
    LodReport report;
    std::string hash;
};

Written write(ooc::Context& context, const Mesh& mesh, const std::vector<VertexId>& ids,
              std::uint64_t window_faces = LodOutput::kWindowFaces) {
    const MeshStore store = test::store_mesh(context, mesh, ids);
    LodOutput output(context, format_of(mesh), false, window_faces);
    Written written;
    const auto sink = collect_mesh(written.mesh);
    output.write(store, *sink, written.report);
    sink->finish();
    written.hash = output.hash().hex();
    return written;
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(a[i], b[i], tolerance);
}

std::vector<Triangle> sorted(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles)
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

/// Surfaces of all kinds: closed, open, in parts, with edges of many faces, not orientable.
std::vector<Mesh> shapes() {
    return {test::cube_sphere(9, 0.05),
            test::torus(30, 11),
            test::plane_grid(20, 0.02),
            test::book(5, 6),
            test::many_spheres(3, 3),
            test::moebius_strip(30, 3),
            test::joined(test::two_sheets(7, 0.1), test::torus(12, 5))};
}

/// Without unused vertices and repeated faces, but with edges of any number of faces.
Mesh tangle(std::uint64_t seed) {
    Mesh mesh = test::random_soup(60, 150, seed);
    std::vector<Triangle> unique;
    for (const Triangle& t : test::triangle_set(mesh.triangles)) {
        if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) unique.push_back(t);
    }
    Mesh result;
    std::vector<std::uint64_t> place(mesh.positions.size(), ~std::uint64_t{0});
    for (Triangle t : unique) {
        for (std::uint64_t& v : t) {
            if (place[v] == ~std::uint64_t{0}) {
                place[v] = result.positions.size();
                result.positions.push_back(mesh.positions[v]);
            }
            v = place[v];
        }
        result.triangles.push_back(t);
    }
    return result;
}

TEST(LodOutput, WritesTheMeshInTheOrderOfIdsWhateverTheWindows) {
    std::uint64_t seed = 0;
    for (const Mesh& mesh : shapes()) {
        const std::vector<VertexId> ids = test::random_ids(mesh.positions.size(), ++seed);
        const Mesh expected = test::sorted_by_id(mesh, ids);
        for (const std::uint64_t window : {1U, 2U, 7U, 100U, 1U << 15}) {
            const auto context = test::make_context();
            const Written written = write(*context, mesh, ids, window);
            EXPECT_EQ(written.report.vertices, mesh.positions.size());
            EXPECT_EQ(written.report.triangles, mesh.triangles.size());
            ASSERT_EQ(written.mesh.positions.size(), expected.positions.size());
            for (std::size_t v = 0; v < expected.positions.size(); ++v) {
                expect_near(written.mesh.positions[v], expected.positions[v], 1e-7);
                for (std::size_t i = 0; i < 3; ++i) {
                    EXPECT_GE(written.mesh.positions[v][i], written.report.bounds.min[i]);
                    EXPECT_LE(written.mesh.positions[v][i], written.report.bounds.max[i]);
                }
            }
            EXPECT_EQ(sorted(written.mesh.triangles), sorted(expected.triangles));
        }
    }
}

TEST(LodOutput, CountsTopologyAsBruteForceDoesWhateverTheWindows) {
    std::vector<Mesh> meshes = shapes();
    for (std::uint64_t seed = 1; seed <= 8; ++seed) meshes.push_back(tangle(seed));
    std::uint64_t seed = 0;
    for (const Mesh& mesh : meshes) {
        const test::Counts counts = test::count(mesh);
        // In the order of the mesh, as along a curve, and in no order.
        std::vector<VertexId> rising;
        for (std::uint64_t v = 0; v < mesh.positions.size(); ++v) rising.push_back(vertex_id(v, 0));
        for (const auto& ids : {rising, test::random_ids(mesh.positions.size(), ++seed)}) {
            for (const std::uint64_t window : {1U, 3U, 10U, 64U, 1U << 15}) {
                const auto context = test::make_context();
                const TopologyReport topology = write(*context, mesh, ids, window).report.topology;
                EXPECT_EQ(topology.border_edges, counts.border_edges) << seed << ' ' << window;
                EXPECT_EQ(topology.nonmanifold_edges, counts.nonmanifold_edges) << seed;
                EXPECT_EQ(topology.nonmanifold_vertices, counts.nonmanifold_vertices) << seed;
                EXPECT_EQ(topology.border_loops, counts.border_loops) << seed << ' ' << window;
                EXPECT_EQ(topology.euler, counts.euler) << seed << ' ' << window;
                EXPECT_EQ(topology.components, test::count_components(mesh)) << seed;
            }
        }
    }
}

TEST(LodOutput, ThreadsPagesAndMemoryDoNotShow) {
    Mesh mesh = test::with_colors(test::with_radial_normals(test::cube_sphere(100, 0.01)));
    for (std::size_t v = 0; v < mesh.normals.size(); v += 5) mesh.normals[v] = {0, 0, 0};
    std::vector<VertexId> ids = test::random_ids(mesh.positions.size(), 3);
    std::sort(ids.begin(), ids.end());  // faces near each other, as along the Morton curve
    const Written expected = write(*test::make_context(1), mesh, ids, 1000);
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        for (const std::uint64_t page_bytes : {4096U, 1U << 20}) {
            // 15 MiB of mesh; 16 MiB are taken at once, 14 MiB with 8 threads by windows.
            ooc::Context context(ooc::ResourceLimits{.memory_bytes = std::uint64_t{40} << 20,
                                                     .n_threads = n_threads,
                                                     .page_bytes = page_bytes});
            const Written written = write(context, mesh, ids, 1000);
            EXPECT_EQ(written.hash, expected.hash);
            EXPECT_EQ(written.mesh.positions, expected.mesh.positions);
            EXPECT_EQ(written.mesh.normals, expected.mesh.normals);
            EXPECT_EQ(written.mesh.colors, expected.mesh.colors);
            EXPECT_EQ(written.mesh.triangles, expected.mesh.triangles);
            if (n_threads == 8) {
                EXPECT_GT(context.spill().bytes_written(), 0U);
            }
            EXPECT_LE(context.budget().peak(), context.budget().limit());
        }
    }
}

TEST(LodOutput, EveryFormatHoldsTheMesh) {
    const test::TempDir folder;
    const auto context = test::make_context();
    const Mesh mesh = test::with_colors(test::with_radial_normals(test::torus(40, 20)));
    const std::vector<VertexId> ids = test::random_ids(mesh.positions.size(), 11);
    const Mesh expected = test::sorted_by_id(mesh, ids);
    const MeshStore store = test::store_mesh(*context, mesh, ids);
    std::vector<std::string> hashes;
    for (const std::string extension : {"ply", "obj", "glb", "stl"}) {
        const std::filesystem::path path = folder.path() / ("out." + extension);
        LodOutput output(*context, format_of(mesh), false, 50);
        LodReport report;
        const auto sink = create_mesh_file(path);
        output.write(store, *sink, report);
        sink->finish();
        hashes.push_back(output.hash().hex());
        EXPECT_EQ(hashes.back(), hashes.front()) << extension;
        const tests::ParsedMesh parsed = extension == "ply"   ? tests::parse_ply(path)
                                         : extension == "obj" ? tests::parse_obj(path)
                                         : extension == "glb" ? tests::parse_glb(path)
                                                              : tests::parse_stl(path);
        if (extension == "stl") {
            // Corner by corner: triangles as points, lowest first.
            const auto corners = [](const auto& positions, const auto& triangles) {
                std::vector<std::array<std::array<float, 3>, 3>> result;
                for (const auto& t : triangles) {
                    auto& corner = result.emplace_back();
                    for (std::size_t i = 0; i < 3; ++i) {
                        for (std::size_t k = 0; k < 3; ++k) {
                            corner[i][k] =
                                static_cast<float>(std::round(positions[t[i]][k] * 1024) / 1024);
                        }
                    }
                    std::rotate(corner.begin(), std::min_element(corner.begin(), corner.end()),
                                corner.end());
                }
                std::sort(result.begin(), result.end());
                return result;
            };
            EXPECT_EQ(corners(parsed.positions, parsed.triangles),
                      corners(expected.positions, expected.triangles));
            continue;
        }
        std::vector<Triangle> triangles(parsed.triangles.begin(), parsed.triangles.end());
        EXPECT_EQ(sorted(triangles), sorted(expected.triangles)) << extension;
        ASSERT_EQ(parsed.positions.size(), expected.positions.size());
        ASSERT_EQ(parsed.colors.size(), expected.colors.size());
        for (std::size_t v = 0; v < expected.positions.size(); ++v) {
            expect_near(parsed.positions[v], expected.positions[v], 1e-6);
            expect_near(parsed.normals[v],
                        {static_cast<double>(expected.normals[v][0]),
                         static_cast<double>(expected.normals[v][1]),
                         static_cast<double>(expected.normals[v][2])},
                        1e-6);
        }
        if (extension == "ply") {
            for (std::size_t v = 0; v < expected.colors.size(); ++v) {
                ASSERT_NEAR(parsed.colors[v][0], expected.colors[v][0] / 257.0, 0.51);
            }
        }
    }
}

TEST(LodOutput, VerticesWithoutANormalGetThatOfTheirFaces) {
    Mesh mesh = test::with_radial_normals(test::cube_sphere(12));
    for (std::size_t v = 0; v < mesh.normals.size(); v += 3) mesh.normals[v] = {0, 0, 0};
    const std::vector<VertexId> ids = test::random_ids(mesh.positions.size(), 4);
    const Mesh sorted_mesh = test::sorted_by_id(mesh, ids);
    std::vector<Vec3> from_faces(mesh.positions.size());
    for (const Triangle& t : sorted_mesh.triangles) {
        for (const std::uint64_t v : t) {
            from_faces[v] = from_faces[v] + test::cross_of(sorted_mesh, t);
        }
    }
    for (const std::uint64_t window : {5U, 100U, 1U << 15}) {
        const auto context = test::make_context();
        const Written written = write(*context, mesh, ids, window);
        ASSERT_EQ(written.mesh.normals.size(), mesh.positions.size());
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            const auto& n = sorted_mesh.normals[v];
            Vec3 expected{static_cast<double>(n[0]), static_cast<double>(n[1]),
                          static_cast<double>(n[2])};
            if (n == std::array<float, 3>{0, 0, 0}) expected = from_faces[v];
            const double length = std::sqrt(dot(expected, expected));
            for (std::size_t i = 0; i < 3; ++i) {
                ASSERT_NEAR(static_cast<double>(written.mesh.normals[v][i]), expected[i] / length,
                            1e-5);
            }
        }
    }
}

TEST(LodOutput, TheErrorBoundIsTheFarthestCornerOfABox) {
    const auto context = test::make_context();
    const Mesh mesh = test::plane_grid(5);
    const Written written = write(*context, mesh, test::random_ids(mesh.positions.size(), 1));
    EXPECT_NEAR(written.report.error_bound, 0.625 * std::sqrt(3.0), 1e-5);
}

TEST(LodOutput, ParentsAreThoseOfTheLastTwoLods) {
    const auto context = test::make_context();
    Mesh fine;
    fine.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    fine.triangles = {{0, 1, 2}, {1, 3, 2}};
    Mesh coarse;
    coarse.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    coarse.triangles = {{0, 1, 2}};
    const std::vector<VertexId> ids{vertex_id(9, 0), vertex_id(4, 1), vertex_id(4, 0),
                                    vertex_id(6, 0)};
    LodOutput output(*context, format_of(fine), true);
    Mesh out;
    LodReport report;
    output.write(test::store_mesh(*context, fine, ids), *collect_mesh(out), report);
    output.write(test::store_mesh(*context, coarse, {ids[0], ids[1], ids[2]}), *collect_mesh(out),
                 report);
    // Fine, by id: 4.0, 4.1, 6.0, 9.0; coarse: 4.0, 4.1, 9.0.
    const std::vector<std::pair<VertexId, VertexId>> merges{{ids[3], ids[1]}};
    EXPECT_EQ(output.parents(merges), (LodParents{0, 1, 1, 2}));
}

TEST(LodOutput, AMeshWithoutFacesIsWritten) {
    const auto context = test::make_context();
    const MeshStore store = test::store_mesh(*context, {}, {});
    LodOutput output(*context, format_of({}), false);
    Mesh out;
    LodReport report;
    output.write(store, *collect_mesh(out), report);
    EXPECT_EQ(report.vertices, 0U);
    EXPECT_EQ(report.topology.components, 0U);
    EXPECT_TRUE(report.bounds.is_empty());
}

}  // namespace
}  // namespace hewer::rsimp
