// SPDX-License-Identifier: MIT
/// Parts that hang on necks thinner than an edge of the result stay where they hang.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

/// Beads of radius 1 in a row, joined by necks of the given radius and length; closed.
Mesh beads(std::uint64_t n_beads, double neck_radius, double neck_length) {
    constexpr std::uint64_t kAround = 48;
    constexpr std::uint64_t kRings = 40;  // of a bead
    const double cut = std::asin(neck_radius);
    Mesh mesh;
    double x = 0;
    for (std::uint64_t bead = 0; bead < n_beads; ++bead) {
        for (std::uint64_t ring = 0; ring <= kRings; ++ring) {
            const double angle =
                cut + (std::numbers::pi - 2 * cut) * static_cast<double>(ring) / kRings;
            for (std::uint64_t i = 0; i < kAround; ++i) {
                const double turn = 2 * std::numbers::pi * static_cast<double>(i) / kAround;
                mesh.positions.push_back({x - std::cos(angle), std::sin(angle) * std::cos(turn),
                                          std::sin(angle) * std::sin(turn)});
            }
        }
        x += 2 + neck_length;
    }
    const std::uint64_t n_rings = n_beads * (kRings + 1);
    for (std::uint64_t ring = 0; ring + 1 < n_rings; ++ring) {
        for (std::uint64_t i = 0; i < kAround; ++i) {
            const std::uint64_t a = ring * kAround + i;
            const std::uint64_t b = ring * kAround + (i + 1) % kAround;
            mesh.triangles.push_back({a, a + kAround, b});
            mesh.triangles.push_back({b, a + kAround, b + kAround});
        }
    }
    const std::uint64_t last = (n_rings - 1) * kAround;
    for (std::uint64_t i = 1; i + 1 < kAround; ++i) {
        mesh.triangles.push_back({0, i, i + 1});
        mesh.triangles.push_back({last, last + i + 1, last + i});
    }
    return mesh;
}

}  // namespace

TEST(Necks, BeadsStayOnTheirString) {
    for (const double length : {0.001, 0.3}) {
        const Mesh mesh = beads(4, 0.002, length);
        ASSERT_TRUE(count(mesh).is_closed());
        for (const double target : {8000.0, 3000.0, 1500.0}) {
            SimplifyOptions options = options_for(Target::Kind::Triangles, target);
            options.method = Method::Full;
            const Outcome run = run_simplify(mesh, options);
            const Counts counts = count(run.lods[0]);
            EXPECT_TRUE(counts.is_closed() && counts.is_clean()) << length << ' ' << target;
            EXPECT_EQ(run.report.lods[0].topology.components, 1U) << length << ' ' << target;
            // With 8000 triangles nearly every vertex is a cluster.
            EXPECT_EQ(run.report.joined_necks > 0, target < 8000) << length << ' ' << target;
            EXPECT_LE(run.lods[0].triangles.size(), target);
        }
    }
}

}  // namespace hewer::test
