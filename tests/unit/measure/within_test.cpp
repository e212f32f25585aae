// SPDX-License-Identifier: MIT
/// What is proven holds for every point, also for those that samples miss.
#include "hewer/within.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "hewer/error.h"
#include "hewer/measure.h"
#include "tests/support/shapes.h"

namespace hewer {
namespace {

using test::cube_sphere;
using test::plane_grid;
using test::Random;
using test::random_soup;
using test::scaled;
using test::translated;
using Verdict = WithinReport::Verdict;

MeasureOptions limits(unsigned n_threads = 2, std::uint64_t memory_bytes = 128 << 20) {
    MeasureOptions options;
    options.memory_bytes = memory_bytes;
    options.n_threads = n_threads;
    return options;
}

WithinReport prove(const Mesh& original, const Mesh& simplified, double distance,
                   const MeasureOptions& options = limits()) {
    const auto a = view_mesh(original, "original");
    const auto b = view_mesh(simplified, "simplified");
    return prove_within(*a, *b, distance, options);
}

double measured(const Mesh& original, const Mesh& simplified, std::uint64_t n_samples) {
    const auto a = view_mesh(original, "original");
    const auto b = view_mesh(simplified, "simplified");
    MeasureOptions options = limits();
    options.n_samples = n_samples;
    const MeasureReport report = measure(*a, *b, options);
    return std::max(report.forward.maximum, report.backward.maximum);
}

/// The square [0, 1]^2 with a pit of `depth` and `radius` at its middle; without one for 0.
Mesh square_with_pit(double depth, double radius) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    if (depth == 0) {
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        return mesh;
    }
    const double lo = 0.5 - radius;
    const double hi = 0.5 + radius;
    mesh.positions.insert(mesh.positions.end(),
                          {{lo, lo, 0}, {hi, lo, 0}, {hi, hi, 0}, {lo, hi, 0}, {0.5, 0.5, -depth}});
    for (std::uint64_t i = 0; i < 4; ++i) {
        const std::uint64_t j = (i + 1) % 4;
        mesh.triangles.push_back({i, j, 4 + j});
        mesh.triangles.push_back({i, 4 + j, 4 + i});
        mesh.triangles.push_back({4 + i, 4 + j, 8});
    }
    return mesh;
}

TEST(ProveWithin, PlanesAreAsFarApartAsTheyAre) {
    const Mesh below = plane_grid(7);
    const Mesh above = translated(plane_grid(5), {0, 0, 0.25});
    EXPECT_EQ(prove(below, above, 0.2501).verdict, Verdict::Proven);
    const WithinReport refuted = prove(below, above, 0.2499);
    EXPECT_EQ(refuted.verdict, Verdict::Refuted);
    EXPECT_GE(refuted.farthest(), 0.249);
    EXPECT_FALSE(refuted.forward.empty());
    EXPECT_FALSE(refuted.backward.empty());
}

TEST(ProveWithin, OneDirectionIsEnoughToRefute) {
    const Mesh large = plane_grid(6);
    Mesh half = plane_grid(6);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return std::any_of(t.begin(), t.end(),
                           [&](std::uint64_t v) { return half.positions[v][0] > 0.5; });
    });
    const WithinReport lost = prove(large, half, 0.3);
    EXPECT_EQ(lost.verdict, Verdict::Refuted);
    EXPECT_TRUE(lost.backward.empty());
    ASSERT_FALSE(lost.forward.empty());
    EXPECT_GT(lost.forward[0].point[0], 0.8);
    const WithinReport grown = prove(half, large, 0.3);
    EXPECT_EQ(grown.verdict, Verdict::Refuted);
    EXPECT_TRUE(grown.forward.empty());
    ASSERT_FALSE(grown.backward.empty());
    EXPECT_GT(grown.backward[0].point[0], 0.75);
    EXPECT_EQ(prove(large, half, 0.501).verdict, Verdict::Proven);
}

TEST(ProveWithin, WhatSamplesMissIsFound) {
    // 1e-7 of the area: of 10,000 samples there is none on average.
    const Mesh pitted = square_with_pit(0.1, 0.00015);
    const Mesh flat = square_with_pit(0, 0);
    // As seen from the flat side, where no vertex is near, there is a gap as wide as the pit only.
    const WithinReport found = prove(flat, pitted, 0.05);
    ASSERT_EQ(found.verdict, Verdict::Refuted);
    ASSERT_FALSE(found.backward.empty());
    EXPECT_NEAR(found.backward[0].point[2], -0.1, 0.051);
    EXPECT_EQ(prove(flat, pitted, 0.1001).verdict, Verdict::Proven);
    EXPECT_EQ(prove(pitted, flat, 0.1001).verdict, Verdict::Proven);

    // A hole in the middle of a triangle: its own center is the farthest point, and no vertex.
    Mesh holed = square_with_pit(0.1, 0.05);
    std::erase_if(holed.triangles, [](const Triangle& t) { return t[2] == 8; });
    EXPECT_LT(measured(flat, holed, 20), 0.045) << "or samples would do";
    EXPECT_EQ(prove(flat, holed, 0.0495).verdict, Verdict::Refuted);
    EXPECT_EQ(prove(holed, flat, 0.0495).verdict, Verdict::Refuted);
    EXPECT_EQ(prove(flat, holed, 0.0505).verdict, Verdict::Proven);
    EXPECT_EQ(prove(holed, flat, 0.0505).verdict, Verdict::Proven);
}

TEST(ProveWithin, FlatSurfacesTriangulatedOtherwiseAreWithinNextToNothing) {
    // Pieces end where the other surface's triangles do; were they halved until they are as small
    // as the distance, a thousand millions of them would not do.
    const Mesh a = plane_grid(40);
    const Mesh b = plane_grid(27);
    const WithinReport near = prove(a, b, 1e-3);
    EXPECT_EQ(near.verdict, Verdict::Proven);
    const WithinReport nearer = prove(a, b, 1e-5);
    EXPECT_EQ(nearer.verdict, Verdict::Proven);
    EXPECT_LT(nearer.n_pieces, 8 * near.n_pieces);
}

TEST(ProveWithin, EqualSurfacesAreWithinAnythingThatCanBeTold) {
    const Mesh mesh = cube_sphere(9, 0.1, 3);
    EXPECT_EQ(prove(mesh, mesh, 1e-6).verdict, Verdict::Proven);
    EXPECT_EQ(prove(mesh, mesh, 1e-9).verdict, Verdict::Undecided)
        << "coordinates are rounded to more than that";
    EXPECT_THROW(prove(mesh, mesh, 0), InvalidArgument);
    EXPECT_THROW(prove(mesh, mesh, std::numeric_limits<double>::quiet_NaN()), InvalidArgument);
    EXPECT_THROW(prove(Mesh(), mesh, 1), InvalidArgument);
}

TEST(ProveWithin, NeedlesAndSpecksComeToAnEnd) {
    Random random(5);
    for (int i = 0; i < 30; ++i) {
        Mesh a = random_soup(30, 40, random.next());
        Mesh b = random_soup(30, 40, random.next());
        // Slivers along one axis, triangles of no area, coordinates that nearly coincide.
        for (Mesh* mesh : {&a, &b}) {
            *mesh = scaled(std::move(*mesh), {1, i % 3 == 0 ? 1e-7 : 1, i % 2 == 0 ? 1e-9 : 0.3});
            mesh->triangles.push_back({0, 0, 1});
            mesh->triangles.push_back({2, 2, 2});
        }
        const double farthest = measured(a, b, 20'000);
        for (const double share : {0.5, 0.9, 1.2, 2.0}) {
            const WithinReport report = prove(a, b, share * farthest);
            // Samples bound the farthest point from below.
            if (share < 1) {
                EXPECT_EQ(report.verdict, Verdict::Refuted) << i << ' ' << share;
            }
            if (share > 1.5) {
                EXPECT_EQ(report.verdict, Verdict::Proven) << i << ' ' << share;
            }
        }
    }
}

TEST(ProveWithin, BracketsWhatManySamplesSay) {
    for (const std::uint64_t seed : {1UL, 2UL, 3UL}) {
        const Mesh fine = cube_sphere(24, 0.03, seed);
        const Mesh coarse = cube_sphere(7, 0.01, seed + 10);
        const double farthest = measured(fine, coarse, 100'000);
        EXPECT_EQ(prove(fine, coarse, 1.03 * farthest).verdict, Verdict::Proven);
        const WithinReport refuted = prove(fine, coarse, 0.99 * farthest);
        EXPECT_EQ(refuted.verdict, Verdict::Refuted);
        EXPECT_GE(refuted.farthest(), 0.98 * farthest);
        EXPECT_LE(refuted.farthest(), 1.03 * farthest);
    }
}

WithinReport prove_parts(const Mesh& original_part, const Mesh& simplified, const Mesh& part,
                         double distance, unsigned n_threads = 2) {
    const auto a = view_mesh(original_part, "original");
    const auto b = view_mesh(simplified, "simplified");
    const auto c = view_mesh(part, "part");
    return prove_parts_within(*a, *b, *c, distance, limits(n_threads));
}

TEST(ProveParts, OfWholeSurfacesSayTheSame) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const Mesh a = cube_sphere(5, 0.1, seed);
        const Mesh b = cube_sphere(4, 0.1, seed + 100);
        const double farthest = measured(a, b, 200'000);
        for (const double share : {0.5, 0.9, 1.05, 1.5}) {
            EXPECT_EQ(prove_parts(a, b, b, share * farthest).verdict,
                      prove(a, b, share * farthest).verdict)
                << seed << ' ' << share;
        }
    }
}

TEST(ProveParts, LookAtThePartsAlone) {
    const Mesh flat = square_with_pit(0, 0);
    const Mesh pit = square_with_pit(0.1, 0.01);
    Mesh away = pit;  // what the pit's own faces are not
    std::erase_if(away.triangles, [](const Triangle& t) { return t[2] == 8; });
    EXPECT_EQ(prove_parts(flat, pit, pit, 0.05).verdict, Verdict::Refuted);
    EXPECT_EQ(prove_parts(flat, pit, away, 0.05).verdict, Verdict::Proven);
    EXPECT_EQ(prove_parts(pit, flat, flat, 0.05).verdict, Verdict::Refuted);
    EXPECT_EQ(prove_parts(away, flat, flat, 0.05).verdict, Verdict::Proven);
}

TEST(ProveParts, ThreadsDoNotShow) {
    const Mesh a = cube_sphere(12, 0.1, 3);
    const Mesh b = cube_sphere(9, 0.1, 4);
    const WithinReport one = prove_parts(a, b, b, 0.05, 1);
    const WithinReport three = prove_parts(a, b, b, 0.05, 3);
    EXPECT_EQ(one.verdict, Verdict::Refuted);
    EXPECT_EQ(one.n_pieces, three.n_pieces);
    ASSERT_EQ(one.forward.size(), three.forward.size());
    ASSERT_EQ(one.backward.size(), three.backward.size());
    for (std::size_t i = 0; i < one.forward.size(); ++i) {
        EXPECT_EQ(one.forward[i].point, three.forward[i].point);
    }
    for (std::size_t i = 0; i < one.backward.size(); ++i) {
        EXPECT_EQ(one.backward[i].point, three.backward[i].point);
    }
}

TEST(ProveWithin, PlacesCloseToEachOtherAreToldApartWhereThatIsAskedFor) {
    // Two pits a fiftieth of the diagonal from each other.
    Mesh pits = square_with_pit(0.1, 0.005);
    const std::uint64_t n = pits.positions.size();
    for (const Vec3& p : translated(square_with_pit(0.1, 0.005), {0.03, 0, 0}).positions) {
        pits.positions.push_back(p);
    }
    for (std::uint64_t i = 0; i < 4; ++i) {
        pits.triangles.push_back({n + 4 + i, n + 4 + (i + 1) % 4, n + 8});
    }
    EXPECT_EQ(prove(pits, square_with_pit(0, 0), 0.05).forward.size(), 1U);
    MeasureOptions finely = limits();
    finely.places_apart = 0.01;
    const WithinReport report = prove(pits, square_with_pit(0, 0), 0.05, finely);
    EXPECT_GE(report.forward.size(), 2U);
    EXPECT_LE(report.forward.size(), 10U);
}

TEST(ProveWithin, ThreadsAndMemoryDoNotShow) {
    // More pieces than one batch has in the smaller limit.
    const Mesh fine = plane_grid(120, 0.004, 1);
    const Mesh coarse = scaled(plane_grid(50, 0.004, 2), {1, 1, 0.5});
    const double farthest = measured(fine, coarse, 50'000);
    for (const double share : {0.7, 1.1}) {
        const WithinReport first = prove(fine, coarse, share * farthest, limits(1, 512 << 20));
        EXPECT_NE(first.verdict, Verdict::Undecided);
        EXPECT_GT(first.n_pieces, std::uint64_t{1} << 15);
        for (const auto& [n_threads, memory] : {std::pair{8U, 512ULL << 20}, {2U, 24ULL << 20}}) {
            const WithinReport report =
                prove(fine, coarse, share * farthest, limits(n_threads, memory));
            EXPECT_EQ(report.verdict, first.verdict);
            EXPECT_EQ(report.n_pieces, first.n_pieces);
            for (const auto places : {&WithinReport::forward, &WithinReport::backward}) {
                ASSERT_EQ((report.*places).size(), (first.*places).size());
                for (std::size_t i = 0; i < (first.*places).size(); ++i) {
                    EXPECT_EQ((report.*places)[i].point, (first.*places)[i].point);
                    EXPECT_EQ((report.*places)[i].distance, (first.*places)[i].distance);
                }
            }
        }
    }
}

}  // namespace
}  // namespace hewer
