// SPDX-License-Identifier: MIT
/// Sums of cells, the store that is made of them, and the estimate of their number.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "cluster/cell_blocks.h"
#include "cluster/cell_sample.h"
#include "ooc/vec3.h"
#include "tests/support/batch_source.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/shapes.h"

namespace hewer::cluster {

namespace {

using test::BatchPlan;
using test::BatchSource;
using test::ClusteredMesh;

auto sums_of(const Mesh& mesh, double resolution, unsigned n_threads, const BatchPlan& plan,
             const Bounds& bounds) {
    const auto context = test::make_context(n_threads);
    BatchSource source(mesh, plan);
    ClusteredMesh clustered(*context, source, resolution, bounds);
    return clustered.sums();
}

/// Quadric of the whole store at x, in cells.
double store_error(const test::Cells& store, const Vec3& x) {
    double sum = 0;
    for (std::uint64_t i = 0; i < store.cells.size(); ++i) {
        const CellRecord& cell = store.cells[i];
        Quadric q;
        for (std::size_t k = 0; k < 6; ++k) q.a[k] = static_cast<double>(cell.quadric[k]);
        for (std::size_t k = 0; k < 3; ++k) q.b[k] = static_cast<double>(cell.quadric[6 + k]);
        q.c = static_cast<double>(cell.quadric[9]);
        Vec3 mean = store.center(i);
        for (std::size_t k = 0; k < 3; ++k) mean[k] += static_cast<double>(cell.mean[k]);
        sum += q.error(x - mean);
    }
    return sum;
}

}  // namespace

TEST(Accumulate, SumsDoNotDependOnOrderThreadsOrFormat) {
    const Mesh mesh = test::cube_sphere(40, 0.03);
    const Bounds bounds = test::bounds_of(mesh);
    for (const double resolution : {1.0, 7.3, 60.0, 5000.0}) {
        const auto expected = sums_of(mesh, resolution, 1, {}, bounds);
        for (const unsigned n_threads : {1U, 2U, 8U}) {
            EXPECT_EQ(sums_of(mesh, resolution, n_threads, {.seed = 3, .largest = 100}, bounds),
                      expected);
            EXPECT_EQ(sums_of(test::shuffled(mesh, 4), resolution, n_threads, {}, bounds),
                      expected);
            EXPECT_EQ(sums_of(mesh, resolution, n_threads, {.is_soup = true}, bounds), expected);
        }
    }
}

TEST(Accumulate, SumsOfPartsAddUpToTheSumsOfTheWhole) {
    const Mesh mesh = test::torus(60, 30);
    const Bounds bounds = test::bounds_of(mesh);
    const auto whole = sums_of(mesh, 25, 2, {.is_soup = true}, bounds);
    auto merged = whole;
    merged.clear();
    for (std::size_t part = 0; part < 3; ++part) {
        Mesh some = mesh;
        some.triangles.clear();
        for (std::size_t i = part; i < mesh.triangles.size(); i += 3) {
            some.triangles.push_back(mesh.triangles[i]);
        }
        for (const auto& [key, values] : sums_of(some, 25, 2, {.is_soup = true}, bounds)) {
            auto& sum = merged[key];
            for (std::size_t i = 0; i < values.size(); ++i) {
                sum[i] += values[i];
                if (i >= 13) sum[i] &= 0xffffffff;  // border sums are modulo 2^32
            }
        }
    }
    EXPECT_EQ(merged, whole);
}

TEST(Accumulate, QuadricsOfAllCellsAddUpToTheSurfaces) {
    test::Random random(8);
    const auto context = test::make_context();
    for (const Mesh& mesh :
         {test::cube_sphere(20, 0.05), test::plane_grid(25, 0.05), test::random_soup(50, 300, 3)}) {
        for (const double resolution : {1.0, 6.5, 40.0, 1000.0}) {
            const test::Cells store(test::cluster_mesh(*context, mesh, resolution, 0));
            const double cell = store.grid.cell_size(store.lattice);
            for (int i = 0; i < 5; ++i) {
                const Vec3 x{random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)};
                const double expected = test::plane_error(mesh, x) / std::pow(cell, 4);
                const Vec3 in_cells = (1 / cell) * (x - store.lattice.origin());
                EXPECT_NEAR(store_error(store, in_cells), expected, 1e-4 * expected) << resolution;
            }
        }
    }
}

TEST(Accumulate, AreaAndSurvivorsAreThoseOfTheMesh) {
    const Mesh mesh = test::cube_sphere(30, 0.02);
    const auto context = test::make_context();
    const auto source = view_mesh(mesh);
    for (const double resolution : {5.0, 50.0, 2000.0}) {
        ClusteredMesh clustered(*context, *source, resolution, test::bounds_of(mesh));
        EXPECT_NEAR(clustered.result.area, test::area(mesh), 1e-3 * test::area(mesh));
        EXPECT_EQ(clustered.result.n_triangles, mesh.triangles.size());
        std::uint64_t survivors = 0;
        for (const Triangle& t : mesh.triangles) {
            std::set<CellKey> cells;
            for (const std::uint64_t v : t) {
                cells.insert(clustered.grid.key(clustered.lattice.encode(mesh.positions[v])));
            }
            survivors += cells.size() == 3 ? 1U : 0U;
        }
        std::uint64_t n = 0;
        for (const TripleList& list : clustered.triples) n += list.size();
        EXPECT_EQ(n, survivors);
    }
}

TEST(BorderSums, VanishOnClosedMeshes) {
    const auto context = test::make_context();
    for (const Mesh& mesh :
         {test::cube_sphere(30, 0.05), test::torus(70, 30), test::many_spheres(2, 8)}) {
        for (const double resolution : {1.0, 3.3, 20.0, 77.7, 10'000.0}) {
            const test::Cells store(test::cluster_mesh(*context, mesh, resolution));
            EXPECT_EQ(store.n_border_cells, 0U);
            for (const CellRecord& cell : store.cells) {
                EXPECT_EQ(cell.flags & CellRecord::kHasBorder, 0U);
            }
            EXPECT_TRUE(store.is_consistently_wound);
        }
    }
}

TEST(BorderSums, FollowTheBorderOfOpenMeshes) {
    const auto context = test::make_context();
    const Mesh mesh = test::plane_grid(60, 0.004);
    for (const double resolution : {5.2, 20.0, 55.0}) {
        const test::Cells store(test::cluster_mesh(*context, mesh, resolution));
        std::set<std::uint64_t> expected;
        for (const Vec3& p : mesh.positions) {
            if (p[0] > 0 && p[0] < 1 && p[1] > 0 && p[1] < 1) continue;
            expected.insert(morton(store.grid.key(store.lattice.encode(p))));
        }
        std::set<std::uint64_t> found;
        for (const CellRecord& cell : store.cells) {
            if ((cell.flags & CellRecord::kHasBorder) != 0) found.insert(store.codes[cell.id]);
        }
        EXPECT_EQ(found, expected);
        EXPECT_EQ(store.n_border_cells, expected.size());
    }
}

TEST(BorderSums, HoldTheLineButNotThePlaceOnIt) {
    const auto context = test::make_context();
    const test::Cells store(test::cluster_mesh(*context, test::plane_grid(60), 10.5));
    const double cell = store.grid.cell_size(store.lattice);
    std::uint64_t seen = 0;
    for (const CellRecord& record : store.cells) {
        const auto at = unpack_morton(store.codes[record.id]);
        if (at[0] != 0 || at[1] < 2 || at[1] > 7) continue;  // along x = 0, away from corners
        ++seen;
        Quadric q;
        for (std::size_t k = 0; k < 6; ++k) q.a[k] = static_cast<double>(record.quadric[k]);
        for (std::size_t k = 0; k < 3; ++k) q.b[k] = static_cast<double>(record.quadric[6 + k]);
        q.c = static_cast<double>(record.quadric[9]);
        Vec3 mean = store.center(record.id);
        for (std::size_t k = 0; k < 3; ++k) mean[k] += static_cast<double>(record.mean[k]);
        for (const double along : {-0.3, 0.0, 0.3}) {
            const Vec3 on_line{0, mean[1] + along, (0 - store.lattice.origin()[2]) / cell};
            EXPECT_NEAR(q.error(on_line - mean), 0, 1e-3);
            EXPECT_GT(q.error(on_line + Vec3{0.5, 0, 0} - mean), 0.1);
        }
    }
    EXPECT_EQ(seen, 6U);
}

TEST(BorderSums, InconsistentWindingIsNoticed) {
    const auto context = test::make_context();
    const Mesh mesh = test::cube_sphere(40, 0.01);
    EXPECT_TRUE(test::cluster_mesh(*context, mesh, 60).is_consistently_wound);
    const test::Cells store(
        test::cluster_mesh(*context, test::with_turned_triangles(mesh, 0.5, 3), 60));
    ASSERT_GT(store.codes.size(), 1000U);
    EXPECT_FALSE(store.is_consistently_wound);
}

TEST(CellBlocks, IsInMortonOrderAndTheSameForSoups) {
    const Mesh mesh = test::cube_sphere(40, 0.01);
    const Bounds bounds = test::bounds_of(mesh);
    const auto context = test::make_context();
    const test::Cells indexed(test::cluster_mesh(*context, mesh, 33.3));
    EXPECT_TRUE(std::is_sorted(indexed.codes.begin(), indexed.codes.end()));
    EXPECT_EQ(std::adjacent_find(indexed.codes.begin(), indexed.codes.end()), indexed.codes.end());
    BatchSource source(mesh, {.is_soup = true});
    ClusteredMesh soup(*context, source, 33.3, bounds);
    const test::Cells other(
        build_cell_blocks(*context, soup.lattice, soup.grid, soup.table, soup.triples, 1));
    EXPECT_EQ(std::vector<std::uint64_t>(indexed.codes.begin(), indexed.codes.end()),
              std::vector<std::uint64_t>(other.codes.begin(), other.codes.end()));
    EXPECT_EQ(indexed.faces.size(), other.faces.size());
    for (std::uint64_t i = 0; i < indexed.cells.size(); ++i) {
        EXPECT_EQ(indexed.cells[i].quadric, other.cells[i].quadric);
        for (const float x : indexed.cells[i].mean) {
            EXPECT_LE(std::abs(x), static_cast<float>(CellRecord::kMostOffset));
        }
    }
}

TEST(CellBlocks, AreTheLargestBoxesThatAreSmallEnough) {
    const auto context = test::make_context();
    const Mesh mesh = test::joined(test::cube_sphere(40, 0.01), test::two_sheets(30, 0.2));
    for (const std::uint64_t most : {1U, 7U, 100U, 3000U, 1000000U}) {
        const test::Cells store(test::cluster_mesh(*context, mesh, 60, 1, most));
        ASSERT_GE(store.blocks.size(), 2U);
        EXPECT_EQ(store.blocks.back().first_cell, store.codes.size());
        EXPECT_EQ(store.blocks.back().first_face, store.faces.size());
        const auto count_in = [&](std::uint64_t code, unsigned shift) {
            const auto low = code >> shift << shift;
            const auto first = std::lower_bound(store.codes.begin(), store.codes.end(), low);
            return std::lower_bound(first, store.codes.end(), low + (std::uint64_t{1} << shift)) -
                   first;
        };
        for (std::size_t b = 0; b + 1 < store.blocks.size(); ++b) {
            const CellBlocks::Block& block = store.blocks[b];
            const std::uint64_t n = store.blocks[b + 1].first_cell - block.first_cell;
            ASSERT_GT(n, 0U);
            ASSERT_LE(n, most);
            ASSERT_EQ(static_cast<std::uint64_t>(count_in(block.box.code, block.box.shift)), n);
            ASSERT_TRUE(block.box.shift == 63 || static_cast<std::uint64_t>(count_in(
                                                     block.box.code, block.box.shift + 3)) > most);
            for (std::uint64_t f = block.first_face; f < store.blocks[b + 1].first_face; ++f) {
                const std::uint32_t median = median_corner(store.faces[f]);
                ASSERT_TRUE(median >= block.first_cell && median < block.first_cell + n);
            }
        }
    }
}

TEST(CellSample, EstimatesTheCellsOfABigSphere) {
    constexpr std::uint64_t kPoints = 1'500'000;
    test::Random random(9);
    Bounds bounds;
    bounds.extend(Vec3{-1, -1, -1});
    bounds.extend(Vec3{1, 1, 1});
    const Lattice lattice(bounds);
    std::vector<LatticePoint> points;
    std::vector<LatticePoint> chosen;
    CellSample sample(kPoints);
    for (std::uint64_t i = 0; i < kPoints; ++i) {
        const double z = random.between(-1, 1);
        const double turn = random.between(0, 2 * std::numbers::pi);
        const double r = std::sqrt(1 - z * z);
        points.push_back(lattice.encode({r * std::cos(turn), r * std::sin(turn), z}));
        if (sample.is_chosen(points.back())) chosen.push_back(points.back());
    }
    sample.add(chosen);
    EXPECT_LT(chosen.size(), kPoints / 4);
    const auto true_count = [&](const UniformGrid& grid) {
        std::vector<CellKey> keys;
        keys.reserve(points.size());
        for (const LatticePoint& p : points) keys.push_back(grid.key(p));
        std::sort(keys.begin(), keys.end());
        return static_cast<double>(std::unique(keys.begin(), keys.end()) - keys.begin());
    };
    for (const double resolution : {128.0, 256.0}) {
        const UniformGrid grid(resolution);
        const double n = true_count(grid);
        EXPECT_NEAR(sample.cells_at(resolution), n, 0.1 * n);
    }
    for (const double wanted : {20'000.0, 150'000.0}) {
        EXPECT_NEAR(true_count(UniformGrid(sample.resolution_for(wanted))), wanted, 0.1 * wanted);
    }
    EXPECT_NEAR(sample.count_positions(), kPoints, 0.1 * kPoints);
}

TEST(CellSample, TheSeparatingGridGivesNearlyEveryVertexItsOwnCell) {
    const Mesh mesh = test::cube_sphere(30, 0.02);
    const Lattice lattice(test::bounds_of(mesh));
    CellSample sample(mesh.positions.size());
    std::vector<LatticePoint> points;
    for (const Vec3& p : mesh.positions) points.push_back(lattice.encode(p));
    sample.add(points);
    const auto n = static_cast<double>(mesh.positions.size());
    EXPECT_EQ(sample.count_positions(), n);
    EXPECT_GE(sample.cells_at(sample.separating_resolution()), 0.995 * n);
    EXPECT_EQ(sample.resolution_for(10 * n), sample.separating_resolution());
}

}  // namespace hewer::cluster
