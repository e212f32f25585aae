// SPDX-License-Identifier: MIT
#include "measure/far_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "ooc/context.h"

namespace hewer::measuring {
namespace {

using Place = FarPlaces::Place;

Bounds unit_box() {
    Bounds box;
    box.extend(Vec3{0, 0, 0});
    box.extend(Vec3{1000, 1000, 1000});
    return box;
}

std::vector<Place> random_places(std::size_t n) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(0, 1000);
    std::vector<Place> places(n);
    for (Place& p : places) p = {at(random), {at(random), at(random), at(random)}};
    return places;
}

std::vector<WorstPlace> worst_of(const FarPlaces& far) {
    Bounds box = unit_box();
    return far.report(Lattice(box), 100);
}

class FarPlacesTest : public ::testing::Test {
  protected:
    ooc::Context context_{{.memory_bytes = 256 << 20, .n_threads = 1}};
};

TEST_F(FarPlacesTest, AreTheWorstAndApart) {
    FarPlaces far(context_, unit_box(), 50);
    EXPECT_TRUE(far.empty());
    const std::vector<Place> places = random_places(3000);
    double greatest = 0;
    for (const Place& p : places) {
        far.add(p.point, p.squared_distance);
        greatest = std::max(greatest, p.squared_distance);
    }
    EXPECT_FALSE(far.empty());
    const Lattice lattice(unit_box());
    const std::vector<WorstPlace> worst = worst_of(far);
    ASSERT_EQ(worst.size(), 100U);
    EXPECT_DOUBLE_EQ(worst[0].distance, std::sqrt(greatest) * lattice.step());
    for (std::size_t i = 0; i < worst.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GE(worst[j].distance, worst[i].distance);
            EXPECT_GE(std::hypot(worst[i].point[0] - worst[j].point[0],
                                 worst[i].point[1] - worst[j].point[1],
                                 worst[i].point[2] - worst[j].point[2]),
                      0.999 * 50 * lattice.step());
        }
    }
}

TEST_F(FarPlacesTest, NeitherOrderNorPartsShowEvenIfCellsHaveToGrow) {
    std::vector<Place> places = random_places(3 * FarPlaces::kMostCells);
    FarPlaces whole(context_, unit_box(), 1);
    for (const Place& p : places) whole.add(p.point, p.squared_distance);

    std::shuffle(places.begin(), places.end(), std::mt19937(9));
    std::vector<FarPlaces> parts;
    parts.reserve(3);
    for (int i = 0; i < 3; ++i) parts.emplace_back(context_, unit_box(), 1);
    // Parts of different sizes: one has to grow its cells and another not.
    for (std::size_t i = 0; i < places.size(); ++i) {
        parts[i < 100 ? 0 : 1 + i % 2].add(places[i].point, places[i].squared_distance);
    }
    for (int i = 1; i < 3; ++i) parts[0].add(parts[static_cast<std::size_t>(i)]);

    const std::vector<WorstPlace> one = worst_of(whole);
    const std::vector<WorstPlace> other = worst_of(parts[0]);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].point, other[i].point);
        EXPECT_EQ(one[i].distance, other[i].distance);
    }
}

TEST_F(FarPlacesTest, NoDistanceIsNoPlace) {
    FarPlaces far(context_, unit_box(), 1);
    far.add({1, 1, 1}, 0);
    EXPECT_TRUE(far.empty());
}

}  // namespace
}  // namespace hewer::measuring
