// SPDX-License-Identifier: MIT
/// --drop-parts with every method, chains of levels and attributes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hewer/error.h"
#include "ooc/vec3.h"
#include "tests/support/dust.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/run_simplify.h"

namespace hewer::test {

namespace {

SimplifyOptions dropping(double size, const std::vector<double>& triangles) {
    SimplifyOptions options;
    for (const double n : triangles) options.targets.push_back({Target::Kind::Triangles, n});
    options.drop_parts = Target{Target::Kind::Error, size};
    return options;
}

bool is_listed(const LostPlaces& places, const Vec3& center, double slack) {
    return std::any_of(places.list.begin(), places.list.end(), [&](const LostPlace& place) {
        return distance(place.center, center) <= slack;
    });
}

}  // namespace

TEST(DropParts, SmallPartsGoAndLargeOnesStayWhateverTheMethod) {
    const Dust dust(24, 0.002, 0.08);
    constexpr double kSize = 0.06;
    for (const Method method : {Method::Refine, Method::Uniform, Method::Full}) {
        SimplifyOptions options = dropping(kSize, {6000, 3000});
        options.method = method;
        if (method == Method::Uniform) options.targets = {{Target::Kind::Triangles, 8000}};
        const Outcome run = run_simplify(dust.mesh, options);
        const double cell = std::sqrt(3.0) * run.report.grid.cell_size;
        for (std::size_t i = 0; i < dust.centers.size(); ++i) {
            const double size = dust.size(i);
            const bool is_dropped = is_listed(run.report.dropped, dust.centers[i], cell);
            if (size < kSize - 2 * cell && size > 4 * cell) {
                EXPECT_TRUE(is_dropped) << size;
            }
            if (size > kSize + 2 * cell) {
                EXPECT_FALSE(is_dropped) << size;
            }
            for (const Mesh& lod : run.lods) {
                if (size < kSize - 2 * cell) {
                    EXPECT_FALSE(dust.is_in(lod, i, cell)) << size;
                }
                if (size > kSize + 2 * cell && method != Method::Uniform) {
                    EXPECT_TRUE(dust.is_in(lod, i, cell)) << size;
                }
                EXPECT_TRUE(count(lod).is_clean());
                EXPECT_TRUE(count(lod).is_closed());
            }
        }
    }
}

TEST(DropParts, NothingChangesWhereNothingIsSmall) {
    const Dust dust(6, 0.05, 0.08);
    SimplifyOptions options = dropping(0.01, {3000});
    const Outcome run = run_simplify(dust.mesh, options);
    options.drop_parts.reset();
    EXPECT_EQ(run.report.result_hash, run_simplify(dust.mesh, options).report.result_hash);
    EXPECT_EQ(run.report.dropped.places, 0U);
}

TEST(DropParts, PercentIsOfTheDiagonal) {
    const Dust dust(12, 0.002, 0.08);
    SimplifyOptions options = dropping(0.06, {3000});
    const Outcome run = run_simplify(dust.mesh, options);
    options.drop_parts =
        Target{Target::Kind::RelativeError, 0.06 / bounds_of(dust.mesh).diagonal()};
    EXPECT_EQ(run.report.result_hash, run_simplify(dust.mesh, options).report.result_hash);
    EXPECT_GT(run.report.dropped.places, 0U);
}

TEST(DropParts, ThreadsAndMemoryDoNotShow) {
    const Dust dust(60, 0.002, 0.05);
    const Mesh mesh = with_colors(dust.mesh);
    const auto run_with = [&](unsigned n_threads, std::uint64_t memory, bool spills) {
        SimplifyOptions options = dropping(0.04, {4000, 500});
        options.n_threads = n_threads;
        options.memory_bytes = memory;
        options.tuning.spills_at_once = spills;
        return run_simplify(mesh, options).report;
    };
    const SimplifyReport expected = run_with(1, std::uint64_t{2} << 30, false);
    EXPECT_GT(expected.dropped.places, 0U);
    for (const unsigned n_threads : {2U, 5U}) {
        const SimplifyReport report = run_with(n_threads, std::uint64_t{96} << 20, true);
        EXPECT_EQ(report.result_hash, expected.result_hash);
        EXPECT_EQ(report.dropped.places, expected.dropped.places);
        EXPECT_EQ(report.dropped.cells, expected.dropped.cells);
    }
}

TEST(DropParts, ASizeMustBeALength) {
    SimplifyOptions options = options_for(Target::Kind::Triangles, 100);
    for (const Target& size :
         {Target{Target::Kind::Triangles, 5}, Target{Target::Kind::Error, 0}}) {
        options.drop_parts = size;
        EXPECT_THROW(run_simplify(cube_sphere(8), options), InvalidArgument);
    }
}

}  // namespace hewer::test
