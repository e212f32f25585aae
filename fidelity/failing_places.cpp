// SPDX-License-Identifier: MIT
#include "fidelity/failing_places.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace hewer::fidelity {

namespace {

// Of the bound: what 99.9 % of a surface must be within to fail in places only.
constexpr double kNearlyAll = 0.6;
// Of the bound: what is farther fails soon.
constexpr double kAboutToFail = 0.9;
// Of a box: half its side in lengths of a triangle, and what its cells count for. Twice the size
// takes so much of the budget that more fails elsewhere; so does ten times the weight.
constexpr double kSize = 0.5;
constexpr double kWeight = 3;
// A side.
constexpr std::size_t kMostBoxes = 10;

bool is_near(const DistanceReport& side, double distance) {
    return side.quantiles.empty() || side.quantiles.back().distance <= distance;
}

}  // namespace

bool fails_in_places(const MeasureReport& measured, double bound) {
    return is_near(measured.forward, kNearlyAll * bound) &&
           is_near(measured.backward, kNearlyAll * bound);
}

void focus_on_failures(const MeasureReport& measured, double bound, double spacing,
                       std::vector<FocusBox>& focus) {
    for (const DistanceReport* side : {&measured.forward, &measured.backward}) {
        const std::size_t n = std::min(side->worst.size(), kMostBoxes);
        for (const WorstPlace& place : std::span(side->worst).first(n)) {
            if (place.distance < kAboutToFail * bound) break;
            // A place of the simplified surface is that far from the original.
            const double half = kSize * spacing + place.distance;
            FocusBox box{.box = {}, .weight = kWeight, .may_be_empty = true};
            for (std::size_t k = 0; k < 3; ++k) {
                box.box.min[k] = place.point[k] - half;
                box.box.max[k] = place.point[k] + half;
            }
            focus.push_back(box);
        }
    }
}

}  // namespace hewer::fidelity
