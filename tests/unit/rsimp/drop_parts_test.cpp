// SPDX-License-Identifier: MIT
#include "rsimp/drop_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "hewer/error.h"
#include "rsimp/cell_parts.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellTriple;

/// A sphere of radius 1 with smaller ones in the corners of its box, which stays its box.
Mesh with_small_parts(std::size_t n_parts, double radius) {
    Mesh mesh = test::cube_sphere(60, 0.01);
    for (Vec3& p : mesh.positions) {
        for (double& x : p) x = std::clamp(x, -0.9, 0.9);
    }
    for (std::size_t i = 0; i < n_parts; ++i) {
        const Vec3 corner{(i & 1) != 0 ? 0.8 : -0.8, (i & 2) != 0 ? 0.8 : -0.8,
                          (i & 4) != 0 ? 0.8 : -0.8};
        mesh = test::joined(
            mesh,
            test::translated(test::scaled(test::cube_sphere(4), {radius, radius, radius}), corner));
    }
    return mesh;
}

SimplifyOptions dropping(double size) {
    SimplifyOptions options;
    options.drop_parts = Target{Target::Kind::Error, size};
    return options;
}

std::multiset<CellTriple> faces_of(const test::Cells& cells, std::size_t block) {
    std::multiset<CellTriple> faces;
    for (std::uint64_t f = cells.blocks[block].first_face; f < cells.blocks[block + 1].first_face;
         ++f) {
        CellTriple t = cells.faces[f];
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        faces.insert(t);
    }
    return faces;
}

void expect_equal(const CellBlocks& blocks, const CellBlocks& expected_blocks) {
    const test::Cells cells(blocks);
    const test::Cells expected(expected_blocks);
    ASSERT_EQ(cells.codes, expected.codes);
    for (std::size_t i = 0; i < cells.cells.size(); ++i) {
        ASSERT_EQ(cells.cells[i].quadric, expected.cells[i].quadric) << i;
        ASSERT_EQ(cells.cells[i].mean, expected.cells[i].mean) << i;
        ASSERT_EQ(cells.cells[i].area, expected.cells[i].area) << i;
        ASSERT_EQ(cells.cells[i].flags, expected.cells[i].flags) << i;
    }
    EXPECT_EQ(cells.attributes.size(), expected.attributes.size());
    ASSERT_EQ(cells.blocks.size(), expected.blocks.size());
    for (std::size_t b = 0; b < cells.blocks.size(); ++b) {
        EXPECT_EQ(cells.blocks[b].box.code, expected.blocks[b].box.code);
        EXPECT_EQ(cells.blocks[b].box.shift, expected.blocks[b].box.shift);
        EXPECT_EQ(cells.blocks[b].first_cell, expected.blocks[b].first_cell);
        EXPECT_EQ(cells.blocks[b].first_face, expected.blocks[b].first_face);
        if (b + 1 < cells.blocks.size()) {
            EXPECT_EQ(faces_of(cells, b), faces_of(expected, b));
        }
    }
    EXPECT_EQ(cells.n_border_cells, expected.n_border_cells);
}

}  // namespace

TEST(CellParts, AreThoseOfBruteForceWhateverTheBlocks) {
    for (const Mesh& mesh :
         {test::many_spheres(3, 5), test::joined(test::two_sheets(9, 0.4), test::torus(20, 9)),
          test::random_soup(60, 40, 7), with_small_parts(8, 0.05)}) {
        for (const std::uint64_t most_cells : {1U << 15, 100U, 9U}) {
            const auto context = test::make_context(3);
            const CellBlocks blocks = test::cluster_mesh(*context, mesh, 30, 1, most_cells);
            const test::Cells cells(blocks);
            std::vector<std::uint64_t> label(cells.codes.size());
            std::iota(label.begin(), label.end(), std::uint64_t{0});
            for (bool is_changed = true; is_changed;) {
                is_changed = false;
                for (const CellTriple& f : cells.faces) {
                    const std::uint64_t least = std::min({label[f[0]], label[f[1]], label[f[2]]});
                    for (const std::uint32_t c : f) {
                        is_changed |= label[c] != least;
                        label[c] = least;
                    }
                }
            }
            CellParts parts(*context, blocks);
            const std::vector<std::uint32_t> pieces = test::read_all(parts.pieces());
            ASSERT_EQ(pieces.size(), label.size());
            std::map<std::uint64_t, std::uint64_t> part_of_label;
            std::set<std::uint64_t> seen;
            for (std::size_t i = 0; i < label.size(); ++i) {
                const std::uint64_t part = parts.part_of(pieces[i]);
                const auto [it, is_new] = part_of_label.emplace(label[i], part);
                EXPECT_EQ(it->second, part);
                EXPECT_EQ(is_new, seen.insert(part).second) << "two parts in one";
            }
        }
    }
}

TEST(DropParts, LeavesWhatClusteringWithoutThemGives) {
    const Mesh whole = with_small_parts(0, 0);
    for (const std::uint64_t most_cells : {1U << 15, 300U, 20U}) {
        const auto context = test::make_context(2);
        const CellBlocks expected = test::cluster_mesh(*context, whole, 40, 1, most_cells);
        SimplifyReport report;
        report.input.bounds = test::bounds_of(whole);
        const CellBlocks dropped = drop_parts(
            *context, test::cluster_mesh(*context, with_small_parts(8, 0.09), 40, 1, most_cells),
            dropping(0.5), report, most_cells);
        expect_equal(dropped, expected);
        EXPECT_EQ(report.dropped.places, 8U);
        ASSERT_EQ(report.dropped.list.size(), 8U);
        for (const LostPlace& place : report.dropped.list) {
            for (const double x : place.center) EXPECT_NEAR(std::abs(x), 0.8, 0.03);
            EXPECT_LE(place.size, 0.18 * std::sqrt(3.0) + 1e-6);
            EXPECT_GE(place.size, 0.18 * std::sqrt(3.0) - 2 * std::sqrt(3.0) / 40);
        }
    }
}

TEST(DropParts, KeepsWhatIsLargeEnough) {
    const Mesh mesh = with_small_parts(8, 0.09);
    const auto context = test::make_context(2);
    const CellBlocks expected = test::cluster_mesh(*context, mesh, 40, 1, 100);
    SimplifyReport report;
    report.input.bounds = test::bounds_of(mesh);
    expect_equal(drop_parts(*context, test::cluster_mesh(*context, mesh, 40, 1, 100),
                            dropping(0.05), report, 100),
                 expected);
    EXPECT_EQ(report.dropped.places, 0U);
    expect_equal(drop_parts(*context, test::cluster_mesh(*context, mesh, 40, 1, 100),
                            SimplifyOptions{}, report, 100),
                 expected);
}

TEST(DropParts, RefusesToDropEverything) {
    const Mesh mesh = with_small_parts(3, 0.05);
    const auto context = test::make_context(2);
    SimplifyReport report;
    report.input.bounds = test::bounds_of(mesh);
    try {
        drop_parts(*context, test::cluster_mesh(*context, mesh, 40), dropping(10), report);
        FAIL();
    } catch (const InvalidArgument& e) {
        EXPECT_NE(std::string(e.what()).find("the largest has a diagonal of 3"), std::string::npos)
            << e.what();
    }
}

}  // namespace hewer::rsimp
