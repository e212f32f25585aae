// SPDX-License-Identifier: MIT
#include "ooc/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace hewer::ooc {
namespace {

TEST(ExactSum, SmallTermsAreNotLostBesideLargeOnes) {
    ExactSum sum;
    sum.add(0x1p60);
    for (int i = 0; i < 1024; ++i) sum.add(0x1p-3);
    EXPECT_EQ(sum.value(), 0x1p60 + 128);
    EXPECT_EQ(ExactSum().value(), 0);
}

TEST(ExactSum, OrderAndPartsDoNotShow) {
    std::mt19937 random(1);
    std::lognormal_distribution<double> term(0, 40);
    std::vector<double> terms(5000);
    for (double& x : terms) x = term(random);
    terms.push_back(0);
    terms.push_back(std::numeric_limits<double>::denorm_min());
    terms.push_back(std::numeric_limits<double>::min());
    ExactSum one;
    for (const double x : terms) one.add(x);
    std::shuffle(terms.begin(), terms.end(), random);
    ExactSum all;
    for (std::size_t part = 0; part < 3; ++part) {
        ExactSum some;
        for (std::size_t i = part; i < terms.size(); i += 3) some.add(terms[i]);
        all.add(some);
    }
    EXPECT_EQ(one.value(), all.value());
    long double expected = 0;
    for (const double x : terms) expected += x;
    EXPECT_NEAR(static_cast<double>(one.value() / expected), 1, 1e-15);
}

TEST(ExactSum, ReachesFromTheLeastDoubleToTheLargest) {
    for (const double x : {std::numeric_limits<double>::denorm_min(), 0x1.fffffffffffffp-1022,
                           std::numeric_limits<double>::min(), 0x1.fffffffffffffp31, 0x1p32,
                           std::numeric_limits<double>::max()}) {
        ExactSum sum;
        sum.add(x);
        EXPECT_EQ(sum.value(), x);
    }
}

}  // namespace
}  // namespace hewer::ooc
