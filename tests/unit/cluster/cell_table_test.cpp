// SPDX-License-Identifier: MIT
#include "cluster/cell_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::cluster {

TEST(CellTable, ManyThreadsFindTheSameSlotsWhileItGrows) {
    constexpr std::uint64_t kKeys = 60'000;
    constexpr std::size_t kThreads = 8;
    const auto context = test::make_context();
    CellTable table(*context, 1, true);
    std::vector<std::vector<std::uint32_t>> slots(kThreads, std::vector<std::uint32_t>(kKeys));
    const auto key_of = [](std::uint64_t i) { return i * 0x3779b97f4a7c15ULL >> 1; };
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            // Each in an order of its own.
            std::vector<std::uint64_t> order(kKeys);
            std::iota(order.begin(), order.end(), 0U);
            test::Random random(t);
            for (std::size_t i = kKeys; i > 1; --i) {
                std::swap(order[i - 1], order[random.below(i)]);
            }
            for (std::size_t begin = 0; begin < kKeys; begin += 500) {
                const CellTable::Admission admission(table, 500);
                for (std::size_t i = begin; i < begin + 500; ++i) {
                    const std::uint32_t slot = table.find_or_insert(key_of(order[i]));
                    slots[t][order[i]] = slot;
                    const FieldLock lock(table.sums(slot).lock);
                    ++table.sums(slot).surface[0];
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(table.size(), kKeys);
    for (std::size_t t = 1; t < kThreads; ++t) EXPECT_EQ(slots[t], slots[0]);
    std::vector<std::uint32_t> sorted = slots[0];
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t i = 0; i < kKeys; ++i) ASSERT_EQ(sorted[i], i);
    std::map<CellKey, std::uint32_t> visited;
    table.for_each([&](CellKey key, std::uint32_t slot) { visited[key] = slot; });
    ASSERT_EQ(visited.size(), kKeys);
    for (std::uint64_t i = 0; i < kKeys; ++i) {
        EXPECT_EQ(visited.at(key_of(i)), slots[0][i]);
        EXPECT_EQ(table.sums(slots[0][i]).surface[0], kThreads);
    }
}

TEST(CellTable, TakesItsBytesFromTheBudget) {
    const auto context = test::make_context();
    const std::uint64_t before = context->budget().used();
    {
        CellTable table(*context, 100'000, false);
        EXPECT_GE(context->budget().used() - before, 100'000 * (sizeof(CellSums) + 17));
    }
    EXPECT_EQ(context->budget().used(), before);
}

}  // namespace hewer::cluster
