// SPDX-License-Identifier: MIT
/// Cells that exceed memory come out like cells that do not.
#include "cluster/cell_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

#include "cluster/vertex_join.h"
#include "cluster/vertex_pages.h"
#include "ooc/parallel.h"
#include "tests/support/batch_source.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::cluster {

namespace {

struct Way {
    std::uint64_t table_cells = 0;   // 0: no spilling
    std::uint64_t window_pages = 0;  // 0: all vertices in memory
    bool is_soup = false;
    unsigned n_threads = 2;
    std::uint64_t seed = 0;  // of the order of batches
};

constexpr std::uint64_t kMostCells = 300;

test::Cells make(const Mesh& mesh, double resolution, const Way& way, std::uint64_t* n_runs) {
    const auto context = test::make_context(way.n_threads);
    test::BatchSource source(
        mesh, {.seed = way.seed, .smallest = 1, .largest = 500, .is_soup = way.is_soup});
    const Bounds bounds = test::bounds_of(mesh);
    const Lattice lattice(bounds);
    const UniformGrid grid(resolution);
    const bool has_attributes = !mesh.colors.empty() && !way.is_soup;
    CellTable table(*context, 16, has_attributes);
    VertexStore store;
    ooc::Spool<LatticePoint> spooled;
    std::optional<VertexPages> pages;
    if (!way.is_soup && way.window_pages == 0) {
        store = load_vertices(*context, source, bounds, lattice);
        pages.emplace(table, store);
    } else if (!way.is_soup) {
        test::BatchSource in_order(mesh, {.seed = 0});
        spooled = spool_vertices(*context, in_order, bounds, lattice);
        pages.emplace(*context, table, source, spooled, lattice, bounds, way.window_pages);
    }
    std::vector<TripleList> triples(context->n_threads());
    CellRuns runs(*context, has_attributes);
    if (way.table_cells != 0) {
        table.set_overflow({way.table_cells, [&] { runs.add(table, triples); }, {}});
    }
    if (has_attributes) add_vertex_attributes(*context, source, lattice, grid, table, nullptr);
    accumulate(*context, {source, lattice, grid, pages ? &*pages : nullptr, bounds}, table, triples,
               false);
    if (n_runs != nullptr) *n_runs = runs.n_runs();
    if (runs.empty()) {
        return test::Cells(
            build_cell_blocks(*context, lattice, grid, table, triples, 3, kMostCells));
    }
    runs.add(table, triples);
    table.release();
    return test::Cells(runs.merge(lattice, grid, 3, kMostCells));
}

void expect_equal(const test::Cells& a, const test::Cells& b) {
    EXPECT_EQ(a.codes, b.codes);
    ASSERT_EQ(a.cells.size(), b.cells.size());
    EXPECT_EQ(std::memcmp(a.cells.data(), b.cells.data(), a.cells.size() * sizeof(CellRecord)), 0);
    ASSERT_EQ(a.attributes.size(), b.attributes.size());
    if (!a.attributes.empty()) {
        EXPECT_EQ(std::memcmp(a.attributes.data(), b.attributes.data(),
                              a.attributes.size() * sizeof(CellAttributes)),
                  0);
    }
    ASSERT_EQ(a.blocks.size(), b.blocks.size());
    EXPECT_EQ(a.n_border_cells, b.n_border_cells);
    EXPECT_EQ(a.is_consistently_wound, b.is_consistently_wound);
    for (std::size_t i = 0; i + 1 < a.blocks.size(); ++i) {
        ASSERT_EQ(a.blocks[i].first_cell, b.blocks[i].first_cell);
        ASSERT_EQ(a.blocks[i].first_face, b.blocks[i].first_face);
        const auto faces_of = [&](const test::Cells& cells) {
            std::vector<CellTriple> faces(
                cells.faces.begin() + static_cast<std::ptrdiff_t>(cells.blocks[i].first_face),
                cells.faces.begin() + static_cast<std::ptrdiff_t>(cells.blocks[i + 1].first_face));
            std::sort(faces.begin(), faces.end());
            return faces;
        };
        ASSERT_EQ(faces_of(a), faces_of(b)) << i;
    }
}

}  // namespace

TEST(CellRuns, NeitherSpillingNorWindowsShow) {
    const std::vector<Mesh> meshes{test::cube_sphere(30, 0.01),
                                   test::with_colors(test::plane_grid(45, 0.02)),
                                   test::random_soup(1200, 3600, 4),
                                   test::with_turned_triangles(test::cube_sphere(25), 0.5, 1)};
    for (const Mesh& mesh : meshes) {
        for (const double resolution : {8.0, 60.0}) {
            const test::Cells expected = make(mesh, resolution, {}, nullptr);
            for (const unsigned n_threads : {1U, 2U, 8U}) {
                for (const std::uint64_t table : {0U, 50U, 700U}) {
                    for (const std::uint64_t window : {0U, 2U}) {
                        std::uint64_t n_runs = 0;
                        const test::Cells other =
                            make(mesh, resolution,
                                 {table, window, false, n_threads, table + window}, &n_runs);
                        EXPECT_TRUE(table != 50 || resolution < 10 || n_runs > 1);
                        expect_equal(expected, other);
                        if (::testing::Test::HasFailure()) {
                            FAIL()
                                << resolution << ' ' << n_threads << ' ' << table << ' ' << window;
                        }
                    }
                }
            }
        }
    }
}

TEST(CellRuns, SoupsToo) {
    const Mesh mesh = test::cube_sphere(40, 0.01);
    const test::Cells expected = make(mesh, 50, {.is_soup = true}, nullptr);
    for (const std::uint64_t table : {60U, 1000U}) {
        expect_equal(expected, make(mesh, 50, {.table_cells = table, .is_soup = true}, nullptr));
    }
}

TEST(VertexJoin, PutsEveryTriangleTogether) {
    const Mesh mesh = test::shuffled(test::cube_sphere(60, 0.01), 5);
    const Bounds bounds = test::bounds_of(mesh);
    const Lattice lattice(bounds);
    const UniformGrid grid(40);
    const test::Cells expected = make(mesh, 40, {}, nullptr);
    for (const std::uint64_t range_bytes : {1U, 1U << 18, 1U << 30}) {
        for (const std::uint64_t table_cells : {200U, 1'000'000U}) {
            const auto context = test::make_context(2);
            test::BatchSource source(mesh, {.seed = 0});
            const ooc::Spool<LatticePoint> spooled =
                spool_vertices(*context, source, bounds, lattice);
            TrianglePartition partition(*context);
            join_vertices(*context, source, spooled, lattice, range_bytes, partition);
            CellTable table(*context, 16, false);
            std::vector<TripleList> triples(2);
            CellRuns runs(*context, false);
            table.set_overflow({table_cells, [&] { runs.add(table, triples); }, {}});
            const AccumulateResult result =
                accumulate(*context, partition, lattice, grid, table, triples, false);
            EXPECT_EQ(result.n_triangles, mesh.triangles.size());
            EXPECT_NEAR(result.area, test::area(mesh), 1e-3 * test::area(mesh));
            runs.add(table, triples);
            table.release();
            expect_equal(expected, test::Cells(runs.merge(lattice, grid, 3, kMostCells)));
        }
    }
}

TEST(VertexPages, TheSmallestWindowWillDo) {
    const Mesh mesh = test::shuffled(test::cube_sphere(60), 3);
    const test::Cells expected = make(mesh, 50, {}, nullptr);
    for (const unsigned n_threads : {1U, 8U}) {
        expect_equal(expected,
                     make(mesh, 50, {.window_pages = 1, .n_threads = n_threads}, nullptr));
    }
}

}  // namespace hewer::cluster
