// SPDX-License-Identifier: MIT
#include "measure/distance_tally.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "measure/worst_places.h"

namespace hewer::measuring {
namespace {

TEST(DistanceTally, SaysTheSameHoweverItsPartsWereShared) {
    std::mt19937 random(1);
    std::lognormal_distribution<double> distance(0, 6);
    std::vector<std::pair<Vec3, double>> points;
    points.reserve(3002);
    for (int i = 0; i < 3000; ++i) {
        points.push_back({{static_cast<double>(i), 0, 0}, distance(random)});
    }
    points.push_back({{9, 9, 9}, 1e9});
    points.push_back({{8, 9, 9}, 1e9});
    DistanceTally one(1000);
    for (const auto& [p, d2] : points) one.add(p, d2);
    std::shuffle(points.begin(), points.end(), random);
    DistanceTally sum(1000);
    for (std::size_t part = 0; part < 7; ++part) {
        DistanceTally tally(1000);
        for (std::size_t i = part; i < points.size(); i += 7) {
            tally.add(points[i].first, points[i].second);
        }
        sum.add(tally);
    }
    EXPECT_EQ(one.n(), sum.n());
    EXPECT_EQ(one.mean(), sum.mean());
    EXPECT_EQ(one.rms(), sum.rms());
    EXPECT_EQ(one.maximum(), sum.maximum());
    EXPECT_EQ(one.worst(), (Vec3{8, 9, 9}));
    EXPECT_EQ(sum.worst(), (Vec3{8, 9, 9}));
    EXPECT_EQ(one.histogram().quantile(0.5), sum.histogram().quantile(0.5));
}

TEST(DistanceTally, QuantilesAreRightToAFewPercent) {
    DistanceHistogram histogram;
    for (int i = 1; i <= 10'000; ++i) {
        const double d = i * 1e-6;
        histogram.add(d * d);
    }
    for (const double share : {0.1, 0.5, 0.9, 0.99, 1.0}) {
        EXPECT_NEAR(histogram.quantile(share), share * 1e-2, 0.031 * share * 1e-2);
    }
}

TEST(DistanceTally, HistogramTakesEveryDistance) {
    DistanceHistogram histogram;
    for (const double d2 : {0.0, 1e-300, 1e-12, 1.0, 1e300}) histogram.add(d2);
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < DistanceHistogram::kBins; ++i) n += histogram.count(i);
    EXPECT_EQ(n, 5U);
    EXPECT_EQ(histogram.count(0), 2U);
    EXPECT_EQ(histogram.count(DistanceHistogram::kBins - 1), 2U);
    EXPECT_DOUBLE_EQ(DistanceHistogram::upper_edge(0), std::ldexp(1, -40));
    EXPECT_DOUBLE_EQ(DistanceHistogram::upper_edge(DistanceHistogram::kBins - 1), 1);
}

TEST(WorstPlaces, AreFarFromEachOtherAndTheWorstThereAre) {
    Bounds box;
    box.extend(Vec3{0, 0, 0});
    box.extend(Vec3{1000, 1000, 0});
    std::mt19937 random(4);
    std::uniform_real_distribution<double> place(0, 1000);
    ooc::Context context({.memory_bytes = 64 << 20, .n_threads = 1});
    WorstPlaces places(context, box);
    std::vector<WorstPlaces::Place> all;
    all.reserve(5000);
    for (int i = 0; i < 5000; ++i) {
        all.push_back({place(random), {place(random), place(random), 0}});
    }
    for (const auto& p : all) places.add(p.point, p.squared_distance);
    const std::vector<WorstPlaces::Place> worst = places.worst(10);
    ASSERT_EQ(worst.size(), 10U);
    double greatest = 0;
    for (const auto& p : all) greatest = std::max(greatest, p.squared_distance);
    EXPECT_EQ(worst[0].squared_distance, greatest);
    for (std::size_t i = 0; i < worst.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GE(worst[j].squared_distance, worst[i].squared_distance);
            EXPECT_GE(std::hypot(worst[i].point[0] - worst[j].point[0],
                                 worst[i].point[1] - worst[j].point[1]),
                      WorstPlaces::kApart * box.diagonal());
        }
    }

    std::shuffle(all.begin(), all.end(), random);
    WorstPlaces shuffled(context, box);
    for (const auto& p : all) shuffled.add(p.point, p.squared_distance);
    const std::vector<WorstPlaces::Place> again = shuffled.worst(10);
    ASSERT_EQ(again.size(), worst.size());
    for (std::size_t i = 0; i < worst.size(); ++i) EXPECT_EQ(worst[i].point, again[i].point);
}

TEST(WorstPlaces, NoDistanceIsNoPlace) {
    Bounds box;
    box.extend(Vec3{5, 5, 5});
    ooc::Context context({.memory_bytes = 64 << 20, .n_threads = 1});
    WorstPlaces places(context, box);
    places.add({5, 5, 5}, 0);
    EXPECT_TRUE(places.worst(10).empty());
    places.add({5, 5, 5}, 2);
    EXPECT_EQ(places.worst(10).size(), 1U);
}

}  // namespace
}  // namespace hewer::measuring
