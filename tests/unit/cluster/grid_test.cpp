// SPDX-License-Identifier: MIT
/// Lattice, uniform grid and Morton codes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "tests/support/shapes.h"

namespace hewer::cluster {

namespace {

constexpr std::array<double, 10> kResolutions{1,    1.5,     2,       3.7,     100.3,
                                              1000, 4095.99, 65536.5, 1000003, 1 << 20};

}  // namespace

TEST(UniformGrid, CellOffsetAndQuantizedAgree) {
    test::Random random(1);
    for (const double resolution : kResolutions) {
        const UniformGrid grid(resolution);
        EXPECT_NEAR(grid.resolution(), resolution, 1e-8 * resolution);
        for (int i = 0; i < 2000; ++i) {
            auto x = static_cast<std::uint32_t>(random.next());
            if (i == 0) x = 0;
            if (i == 1) x = std::numeric_limits<std::uint32_t>::max();
            const double place = x * grid.step_in_cells();
            EXPECT_NEAR(grid.cell(x) + 0.5 + grid.offset(x), place, 1e-9);
            EXPECT_GE(grid.offset(x), -0.5);
            EXPECT_LE(grid.offset(x), 0.5);
            for (const unsigned bits : {0U, 4U, 8U}) {
                const std::int64_t q = grid.quantized(x, bits);
                EXPECT_EQ(q >> bits, grid.cell(x));
                EXPECT_LE(
                    std::abs(std::ldexp(static_cast<double>(q), -static_cast<int>(bits)) - place),
                    std::ldexp(1.0, -static_cast<int>(bits)));
            }
        }
        EXPECT_LE(grid.cell(std::numeric_limits<std::uint32_t>::max()), std::ceil(resolution));
    }
}

TEST(UniformGrid, CellsRiseAlongAnAxis) {
    test::Random random(2);
    for (const double resolution : kResolutions) {
        const UniformGrid grid(resolution);
        for (int i = 0; i < 500; ++i) {
            const auto x = static_cast<std::uint32_t>(random.next());
            const auto step = static_cast<std::uint32_t>(random.below(1 << 20));
            if (x + step < x) continue;
            EXPECT_LE(grid.cell(x), grid.cell(x + step));
        }
    }
}

TEST(UniformGrid, ResolutionIsClampedToItsRange) {
    EXPECT_NEAR(UniformGrid(0.01).resolution(), 1, 1e-8);
    EXPECT_NEAR(UniformGrid(1e9).resolution(), UniformGrid::kMaxResolution, 1e-2);
}

TEST(UniformGrid, KeysHoldTheCellOfEveryAxis) {
    test::Random random(3);
    for (const double resolution : kResolutions) {
        const UniformGrid grid(resolution);
        for (int i = 0; i < 500; ++i) {
            const LatticePoint p{static_cast<std::uint32_t>(random.next()),
                                 static_cast<std::uint32_t>(random.next()),
                                 static_cast<std::uint32_t>(random.next())};
            const auto c = unpack(grid.key(p));
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(c[k], grid.cell(p[k]));
        }
    }
}

TEST(Morton, ComesBackAndNestsInHalvedCoordinates) {
    test::Random random(4);
    for (int i = 0; i < 5000; ++i) {
        std::array<std::uint32_t, 3> c{};
        for (auto& x : c) x = static_cast<std::uint32_t>(random.below(1 << 21));
        const auto key = [](const std::array<std::uint32_t, 3>& a) {
            return static_cast<CellKey>(a[0]) | static_cast<CellKey>(a[1]) << 21 |
                   static_cast<CellKey>(a[2]) << 42;
        };
        const std::uint64_t code = morton(key(c));
        EXPECT_EQ(unpack_morton(code), c);
        EXPECT_EQ(code >> 3, morton(key({c[0] / 2, c[1] / 2, c[2] / 2})));
        EXPECT_EQ(code & 7, (c[0] & 1) | (c[1] & 1) << 1 | (c[2] & 1) << 2);
    }
}

TEST(Lattice, RoundsToTheNearestStepAnywhereInSpace) {
    test::Random random(5);
    for (const Vec3& origin : {Vec3{0, 0, 0}, Vec3{5e5, 5e6, 100}, Vec3{-3, 1e-3, 7}}) {
        Bounds bounds;
        bounds.extend(origin);
        bounds.extend(Vec3{origin[0] + 2, origin[1] + 0.5, origin[2] + 1});
        const Lattice lattice(bounds);
        EXPECT_NEAR(lattice.step(), 2 / Lattice::kSteps, 1e-6 * 2 / Lattice::kSteps);
        EXPECT_EQ(lattice.encode(bounds.min), (LatticePoint{0, 0, 0}));
        EXPECT_EQ(lattice.encode(bounds.max)[0], 4294967294U);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 p{origin[0] + random.between(0, 2), origin[1] + random.between(0, 0.5),
                         origin[2] + random.between(0, 1)};
            const LatticePoint q = lattice.encode(p);
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(lattice.origin()[k] + q[k] * lattice.step(), p[k],
                            0.51 * lattice.step() + 2e-9);
            }
        }
    }
}

TEST(Lattice, ABoxOfOnePointHasOnePoint) {
    Bounds bounds;
    bounds.extend(Vec3{1, 2, 3});
    const Lattice lattice(bounds);
    EXPECT_EQ(lattice.encode({1, 2, 3}), (LatticePoint{0, 0, 0}));
    EXPECT_TRUE(std::isfinite(lattice.step()));
}

}  // namespace hewer::cluster
