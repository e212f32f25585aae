// SPDX-License-Identifier: MIT
/// Places are told from a surface that is too far at large, and get boxes.
#include "fidelity/failing_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace hewer::fidelity {

namespace {

/// Nearly all of both surfaces is within `nearly_all`; forward there are places of these distances.
MeasureReport report_of(double nearly_all, const std::vector<double>& distances) {
    MeasureReport report;
    report.forward.quantiles =
        report.backward.quantiles = {{0.5, 0.1 * nearly_all}, {0.999, nearly_all}};
    for (const double d : distances) {
        report.forward.worst.push_back({{10 * d, 0, 1}, d});
        report.forward.maximum = std::max(report.forward.maximum, d);
    }
    return report;
}

}  // namespace

TEST(FailingPlaces, AreNotASurfaceThatIsTooFarAtLarge) {
    EXPECT_TRUE(fails_in_places(report_of(0.3, {2}), 1));
    EXPECT_FALSE(fails_in_places(report_of(0.9, {2}), 1));
    MeasureReport backward = report_of(0.3, {2});
    backward.backward.quantiles.back().distance = 0.9;
    EXPECT_FALSE(fails_in_places(backward, 1));
}

TEST(FailingPlaces, GetBoxesThatReachTheOriginalAndNoOthersDo) {
    std::vector<FocusBox> focus;
    MeasureReport report = report_of(0.3, {2, 1.1, 0.5});
    report.backward.worst.push_back({{-5, 0, 0}, 1.5});
    focus_on_failures(report, 1, 0.4, focus);
    ASSERT_EQ(focus.size(), 3U);
    const std::array<WorstPlace, 3> places{report.forward.worst[0], report.forward.worst[1],
                                           report.backward.worst[0]};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_GT(focus[i].weight, 1);
        EXPECT_TRUE(focus[i].may_be_empty);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LE(focus[i].box.min[k], places[i].point[k] - places[i].distance);
            EXPECT_GE(focus[i].box.max[k], places[i].point[k] + places[i].distance);
        }
    }
    focus_on_failures(report, 1, 0.4, focus);
    EXPECT_EQ(focus.size(), 6U) << "what fails again gets more weight";
}

}  // namespace hewer::fidelity
