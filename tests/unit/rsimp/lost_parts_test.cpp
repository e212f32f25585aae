// SPDX-License-Identifier: MIT
#include "rsimp/lost_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "rsimp/cluster_mesh_builder.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

namespace {

constexpr PlaceFrame kFrame{{10, 20, 30}, 0.5};

LostPart cell_box(const Vec3& low, double size, std::uint32_t n_cells, bool is_unseen = false) {
    LostPart part{{}, n_cells, is_unseen ? 1U : 0U};
    for (std::size_t k = 0; k < 3; ++k) {
        part.box[k] = static_cast<float>(low[k]);
        part.box[3 + k] = static_cast<float>(low[k] + size);
    }
    return part;
}

LostPlaces places_of(const std::vector<LostPart>& parts) {
    const auto context = test::make_context();
    ooc::Spool<LostPart> spool;
    append_lost(*context, parts, spool);
    return find_places(*context, spool, kFrame);
}

bool touch(const LostPart& a, const LostPart& b) {
    bool result = true;
    for (std::size_t k = 0; k < 3; ++k) {
        result = result && a.box[k] <= b.box[3 + k] && b.box[k] <= a.box[3 + k];
    }
    return result;
}

std::vector<LostPart> random_parts(std::size_t n, double extent, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<LostPart> parts;
    for (std::size_t i = 0; i < n; ++i) {
        const double size = 1.0 + static_cast<double>(random.below(3));
        Vec3 low{};
        for (double& x : low) x = std::floor(random.between(-extent, extent));
        parts.push_back(cell_box(low, size, static_cast<std::uint32_t>(1 + random.below(9))));
    }
    return parts;
}

void expect_equal(const LostPlaces& a, const LostPlaces& b) {
    EXPECT_EQ(a.places, b.places);
    EXPECT_EQ(a.cells, b.cells);
    ASSERT_EQ(a.list.size(), b.list.size());
    for (std::size_t i = 0; i < a.list.size(); ++i) {
        EXPECT_EQ(a.list[i].center, b.list[i].center);
        EXPECT_EQ(a.list[i].size, b.list[i].size);
        EXPECT_EQ(a.list[i].cells, b.list[i].cells);
    }
}

std::vector<LostPart> unseen_cells(const Mesh& mesh, double resolution, std::uint64_t most_cells) {
    const auto context = test::make_context();
    const cluster::CellBlocks cells = test::cluster_mesh(*context, mesh, resolution, 1, most_cells);
    ooc::Spool<LostPart> lost;
    find_unseen_cells(*context, cells, cells_as_clusters(*context, cells), lost);
    return test::read_all(lost);
}

/// A closed triangle of no thickness, well inside a cell of size 1.
Mesh speck(const Vec3& at) {
    Mesh mesh;
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0.2, 0, 0}, Vec3{0, 0.2, 0.1}}) {
        mesh.positions.push_back({at[0] + p[0], at[1] + p[1], at[2] + p[2]});
    }
    mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
    return mesh;
}

}  // namespace

TEST(LostPlaces, NothingIsLostWhereThereAreNoParts) {
    const LostPlaces places = places_of({});
    EXPECT_EQ(places.places, 0U);
    EXPECT_TRUE(places.list.empty());
}

TEST(LostPlaces, BoxesThatTouchAreOnePlaceInModelUnits) {
    // Two that share a corner, one that is a cell away.
    const LostPlaces places = places_of(
        {cell_box({0, 0, 0}, 1, 3), cell_box({1, 1, 1}, 1, 4), cell_box({3, 0, 0}, 1, 5)});
    EXPECT_EQ(places.places, 2U);
    EXPECT_EQ(places.cells, 12U);
    ASSERT_EQ(places.list.size(), 2U);
    EXPECT_EQ(places.list[0].cells, 7U);
    EXPECT_DOUBLE_EQ(places.list[0].size, 0.5 * std::sqrt(12.0));
    EXPECT_EQ(places.list[0].center, (Vec3{10.5, 20.5, 30.5}));
    EXPECT_EQ(places.list[1].cells, 5U);
}

TEST(LostPlaces, AreThoseOfBruteForceInAnyOrder) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        std::vector<LostPart> parts = random_parts(300, 12, seed);
        std::vector<std::size_t> label(parts.size());
        std::iota(label.begin(), label.end(), std::size_t{0});
        bool is_changed = true;
        while (is_changed) {
            is_changed = false;
            for (std::size_t i = 0; i < parts.size(); ++i) {
                for (std::size_t j = 0; j < parts.size(); ++j) {
                    if (label[j] >= label[i] || !touch(parts[i], parts[j])) continue;
                    label[i] = label[j];
                    is_changed = true;
                }
            }
        }
        std::uint64_t n_places = 0;
        std::uint64_t n_cells = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (label[i] == i) ++n_places;
            n_cells += parts[i].n_cells;
        }
        const LostPlaces places = places_of(parts);
        EXPECT_EQ(places.places, n_places);
        EXPECT_EQ(places.cells, n_cells);
        EXPECT_EQ(places.list.size(), std::min<std::uint64_t>(LostPlaces::kMostListed, n_places));
        for (std::size_t i = 0; i + 1 < places.list.size(); ++i) {
            EXPECT_GE(places.list[i].size, places.list[i + 1].size);
        }
        std::reverse(parts.begin(), parts.end());
        expect_equal(places, places_of(parts));
    }
}

TEST(LostPlaces, MoreThanAreComparedAtOnceAreAllCountedAndTheLargestListed) {
    std::vector<LostPart> parts;
    for (std::uint64_t i = 0; i < kPartsAtOnce + 5000; ++i) {
        const auto x = static_cast<double>(3 * (i % 300));
        const std::uint64_t row = i / 300;
        const auto y = static_cast<double>(3 * row);
        parts.push_back(cell_box({x, y, 0}, i % 7000 == 77 ? 2 : 1, 2));
    }
    const LostPlaces places = places_of(parts);
    EXPECT_EQ(places.places, parts.size());
    EXPECT_EQ(places.cells, 2 * parts.size());
    ASSERT_EQ(places.list.size(), LostPlaces::kMostListed);
    for (std::size_t i = 0; i < places.list.size(); ++i) {
        EXPECT_DOUBLE_EQ(places.list[i].size, (i < 11 ? 1 : 0.5) * std::sqrt(3.0)) << i;
    }
    std::reverse(parts.begin(), parts.end());
    expect_equal(places, places_of(parts));
}

TEST(LostPlaces, AnUnseenCellOfALostClusterCountsOnce) {
    EXPECT_EQ(places_of({cell_box({0, 0, 0}, 2, 3), cell_box({1, 1, 1}, 1, 1, true)}).cells, 3U);
    EXPECT_EQ(places_of({cell_box({1, 1, 1}, 1, 1), cell_box({1, 1, 1}, 1, 1, true)}).cells, 1U);
    EXPECT_EQ(places_of({cell_box({0, 0, 0}, 2, 3), cell_box({2, 1, 1}, 1, 1, true)}).cells, 4U);
}

TEST(UnseenCells, AreThoseWithoutAFaceAwayFromAllFaces) {
    // A sphere of radius 20 in a grid of cells of about 1; specks apart from it, and one at it.
    Mesh mesh = test::scaled(test::cube_sphere(30, 0.0), {20, 20, 20});
    const std::size_t n_without = unseen_cells(mesh, 41, 1 << 15).size();
    EXPECT_EQ(n_without, 0U);
    mesh = test::joined(mesh, speck({0.3, 0.3, 0.3}));
    mesh = test::joined(mesh, speck({5.3, -6.7, 0.3}));
    mesh = test::joined(mesh, speck({19.6, 0.3, 0.3}));
    std::vector<LostPart> whole;
    for (const std::uint64_t most_cells : {1U << 15, 200U, 8U}) {
        const std::vector<LostPart> unseen = unseen_cells(mesh, 40, most_cells);
        EXPECT_GE(unseen.size(), 2U);
        EXPECT_LE(unseen.size(), 6U) << "a speck may lie across the side of a cell";
        for (const LostPart& part : unseen) {
            EXPECT_EQ(part.n_cells, 1U);
            EXPECT_EQ(part.is_unseen, 1U);
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(part.box[3 + k] - part.box[k], 1.0F);
        }
        EXPECT_EQ(places_of(unseen).places, 2U);
        if (whole.empty()) whole = unseen;
        EXPECT_EQ(places_of(unseen).cells, places_of(whole).cells) << "blocks do not show";
    }
}

TEST(UnseenCells, PartsThatShareTheirClustersAreUnseen) {
    // Spheres some cells across, and one cluster, two, or one for each octant of the box.
    const Mesh mesh = test::joined(
        test::cube_sphere(40),
        test::translated(test::scaled(test::cube_sphere(4), {0.1, 0.1, 0.1}), {0.8, 0.8, 0.8}));
    for (const std::uint64_t most_cells : {1U << 15, 300U}) {
        const auto context = test::make_context();
        const cluster::CellBlocks cells = test::cluster_mesh(*context, mesh, 40, 1, most_cells);
        const auto unseen_with = [&](const GroupCells& group) {
            ooc::Spool<LostPart> lost;
            find_unseen_cells(*context, cells, build_cluster_mesh(*context, cells, group), lost);
            return places_of(test::read_all(lost));
        };
        // Pairs of cells: both parts are there. Blocks as clusters: a part inside one is not.
        const LostPlaces pairs = unseen_with([&](std::size_t b, CellGroups& groups) {
            const std::uint64_t n = cells.blocks[b + 1].first_cell - cells.blocks[b].first_cell;
            for (std::uint64_t i = 0; i < n; i += 2) {
                groups.begins.push_back(static_cast<LocalCell>(i));
            }
        });
        EXPECT_EQ(pairs.places, 0U);
        const LostPlaces whole =
            unseen_with([](std::size_t, CellGroups& groups) { groups.begins = {0}; });
        if (most_cells == 300) {
            ASSERT_EQ(whole.places, 1U);
            for (const double x : whole.list[0].center) EXPECT_GT(x, 0);
            EXPECT_GT(whole.cells, 20U);
            EXPECT_LT(whole.cells, 300U);
        } else {
            EXPECT_EQ(whole.places, 2U) << "one cluster shows nothing";
        }
    }
}

}  // namespace hewer::rsimp
