// SPDX-License-Identifier: MIT
#include "streaming/position_precision.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hewer::streaming {
namespace {

Bounds box(const Vec3& origin, double size) {
    Bounds b;
    b.extend(origin);
    b.extend(Vec3{origin[0] + size, origin[1] + size, origin[2] + size});
    return b;
}

TEST(PositionPrecision, ModelsNearTheOriginAreFineInFloat) {
    EXPECT_FALSE(float_is_too_coarse(box({-0.5, -0.5, -0.5}, 1)));
    EXPECT_FALSE(float_is_too_coarse(box({0, 0, 0}, 1e6)));
    EXPECT_FALSE(float_is_too_coarse(box({50, 50, 50}, 1)));
    EXPECT_FALSE(float_is_too_coarse(Bounds{}));
}

TEST(PositionPrecision, MapCoordinatesAreNot) {
    EXPECT_TRUE(float_is_too_coarse(box({5e6, 4e5, 0}, 1000)));
    EXPECT_FALSE(float_is_too_coarse(box({5e6, 4e5, 0}, 100'000)));
}

TEST(PositionPrecision, SwitchesWhereHalfAStepIsAHundredThousandthOfTheDiagonal) {
    const double edge = 0x1p20 * 0x1p-24 / 1e-5;  // of diagonals with a largest coordinate of 2^20
    const auto flat = [&](double diagonal) {
        Bounds b;
        b.extend(Vec3{0x1p20, 0, 0});
        b.extend(Vec3{0x1p20, diagonal, 0});
        return b;
    };
    EXPECT_TRUE(float_is_too_coarse(flat(edge * 0.999)));
    EXPECT_FALSE(float_is_too_coarse(flat(edge * 1.001)));
}

TEST(PositionPrecision, BeyondTheRangeOfFloatIsTooCoarse) {
    EXPECT_TRUE(float_is_too_coarse(box({0, 0, 0}, 1e39)));
    EXPECT_TRUE(float_is_too_coarse(box({0, 0, 0}, 1e-43)));
    EXPECT_FALSE(float_is_too_coarse(box({0, 0, 0}, 1e-30)));
}

TEST(PositionPrecision, DoubleNeedsAnInputOfDoubles) {
    SinkHeader header;
    header.bounds = box({5e6, 4e5, 0}, 1000);
    EXPECT_FALSE(needs_double(header));
    header.has_double_positions = true;
    EXPECT_TRUE(needs_double(header));
    header.bounds = box({0, 0, 0}, 1);
    EXPECT_FALSE(needs_double(header));
}

TEST(PositionPrecision, LocalOriginMakesFloatFine) {
    for (const double size : {1e-3, 1.0, 1000.0, 3e5}) {
        const Bounds b = box({5'000'123.4, 448'017.9, -312.7}, size);
        const Vec3 o = local_origin(b);
        Bounds local;
        local.extend(Vec3{b.min[0] - o[0], b.min[1] - o[1], b.min[2] - o[2]});
        local.extend(Vec3{b.max[0] - o[0], b.max[1] - o[1], b.max[2] - o[2]});
        EXPECT_FALSE(float_is_too_coarse(local)) << size;
        const double unit = std::exp2(std::floor(std::log2(b.diagonal())));
        for (const double x : o) EXPECT_EQ(std::remainder(x, unit), 0) << size;
    }
}

TEST(PositionPrecision, LocalOriginOfAPointIsThePoint) {
    EXPECT_EQ(local_origin(box({5e6 + 0.1, 2, 3}, 0)), (Vec3{5e6 + 0.1, 2, 3}));
}

}  // namespace
}  // namespace hewer::streaming
