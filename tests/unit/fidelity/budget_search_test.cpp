// SPDX-License-Identifier: MIT
/// The search ends, on a budget that is good, and near the smallest one where distances are smooth.
#include "fidelity/budget_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace hewer::fidelity {

namespace {

using Distance = std::function<double(std::uint64_t)>;

struct Found {
    std::optional<std::uint64_t> budget;
    std::vector<std::uint64_t> tries;
};

Found search(const Distance& distance, double bound, std::uint64_t least, std::uint64_t first,
             std::uint64_t most) {
    BudgetSearch search(least, first, most);
    search.set_bound(bound);
    Found found;
    while (const auto budget = search.next()) {
        EXPECT_GE(*budget, least);
        EXPECT_LE(*budget, most);
        found.tries.push_back(*budget);
        search.add(*budget, distance(*budget));
        if (found.tries.size() > BudgetSearch::kMostTries) break;
    }
    EXPECT_LE(found.tries.size(), BudgetSearch::kMostTries);
    found.budget = search.best();
    return found;
}

double noise(std::uint64_t x) {
    x = x * 0x9e3779b97f4a7c15ULL;
    return static_cast<double>((x ^ x >> 29) >> 40) / (1 << 24);
}

}  // namespace

TEST(BudgetSearch, FindsTheSmallestGoodBudgetOfASmoothFall) {
    for (const double power : {0.5, 1.0, 2.0}) {
        for (const double smallest : {10.0, 3000.0, 123'456.0, 900'000.0}) {
            const Distance distance = [&](std::uint64_t n) {
                return std::pow(smallest / static_cast<double>(n), power);
            };
            const Found found = search(distance, 1, 4, 50'000, 1'000'000);
            ASSERT_TRUE(found.budget);
            EXPECT_GE(static_cast<double>(*found.budget), smallest);
            EXPECT_LE(static_cast<double>(*found.budget), 1.08 * smallest + 1)
                << power << ' ' << found.tries.size() << " tries";
        }
    }
}

TEST(BudgetSearch, GoodResultsThatAreBarelySoDoNotMakeItCreep) {
    // Repaired results are just within the bound, whatever the budget.
    const Distance distance = [](std::uint64_t n) { return n < 83'000 ? 1.1 : 0.97; };
    const Found found = search(distance, 1, 4, 80'000, 300'000);
    ASSERT_TRUE(found.budget);
    EXPECT_LE(static_cast<double>(*found.budget), 83'000 * 1.05);
    EXPECT_LE(found.tries.size(), 6U);
}

TEST(BudgetSearch, EndsOnAGoodBudgetWhateverTheNoise) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Distance distance = [&](std::uint64_t n) {
            return 20'000 / static_cast<double>(n) * std::exp(2 * noise(n + 7919 * seed) - 1);
        };
        const Found found = search(distance, 1, 4, 50'000, 1'000'000);
        ASSERT_TRUE(found.budget);
        EXPECT_LE(distance(*found.budget), 1);
    }
}

TEST(BudgetSearch, TriesEverythingThereIsBeforeItGivesUp) {
    const Found found = search([](std::uint64_t) { return 5.0; }, 1, 4, 500, 100'000);
    EXPECT_FALSE(found.budget);
    EXPECT_EQ(found.tries.back(), 100'000U);
}

TEST(BudgetSearch, EndsAtTheLeastBudgetWhereAllAreGood) {
    const Found found = search([](std::uint64_t) { return 0.0; }, 1, 4, 500, 100'000);
    EXPECT_EQ(found.budget, 4U);
}

TEST(BudgetSearch, StaysWithinAnInputThatIsSmallerThanItsFirstTry) {
    const Found found = search([](std::uint64_t n) { return n >= 9 ? 0.5 : 2.0; }, 1, 4, 500, 12);
    EXPECT_EQ(found.budget, 9U);
}

}  // namespace hewer::fidelity
