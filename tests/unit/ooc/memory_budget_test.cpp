// SPDX-License-Identifier: MIT
#include "ooc/memory_budget.h"

#include <gtest/gtest.h>

#include "hewer/error.h"
#include "ooc/array.h"

namespace hewer::ooc {
namespace {

TEST(MemoryBudget, RefusesWhatExceedsTheLimitAndNamesTheSufficientOne) {
    MemoryBudget budget(1 << 20, 0);
    const Reservation r = budget.reserve("first", 1 << 19);
    try {
        const Reservation second = budget.reserve("second", 1 << 20);
        FAIL() << "was granted";
    } catch (const OutOfMemoryBudget& e) {
        EXPECT_NE(std::string(e.what()).find("second needs 1.00 MiB"), std::string::npos)
            << e.what();
        EXPECT_NE(std::string(e.what()).find("1.50 MiB"), std::string::npos) << e.what();
    }
    EXPECT_EQ(budget.used(), 1U << 19);
}

TEST(MemoryBudget, SurvivesRequestsThatWouldOverflow) {
    MemoryBudget budget(1 << 20, 0);
    const Reservation r = budget.reserve("first", 100);
    EXPECT_THROW((void)budget.reserve("all", ~0ULL), OutOfMemoryBudget);
    EXPECT_THROW((void)budget.reserve("all", ~0ULL - 50), OutOfMemoryBudget);
    EXPECT_EQ(budget.used(), 100U);
}

TEST(MemoryBudget, GetsBytesBackAndRemembersThePeak) {
    MemoryBudget budget(1 << 20, 1000);
    {
        Reservation a = budget.reserve("a", 5000);
        const Reservation b = std::move(a);
        EXPECT_EQ(budget.used(), 6000U);
    }
    EXPECT_EQ(budget.used(), 1000U);
    EXPECT_EQ(budget.peak(), 6000U);
    budget.reset_peak();
    EXPECT_EQ(budget.peak(), 1000U);
}

TEST(MemoryBudget, DefaultLimitIsPositive) {
    EXPECT_GT(default_memory_limit(), 1U << 20);
}

TEST(Array, IsZeroedAndAccountedFor) {
    MemoryBudget budget(64 << 20, 0);
    for (const std::uint64_t n : {std::uint64_t{0}, std::uint64_t{10}, std::uint64_t{1} << 20}) {
        Array<std::uint64_t> a(budget, "numbers", n);
        EXPECT_EQ(budget.used(), n * 8);
        for (const std::uint64_t x : a) ASSERT_EQ(x, 0U);
        Array<std::uint64_t> b = std::move(a);
        EXPECT_EQ(b.size(), n);
        EXPECT_EQ(budget.used(), n * 8);
    }
    EXPECT_EQ(budget.used(), 0U);
}

}  // namespace
}  // namespace hewer::ooc
