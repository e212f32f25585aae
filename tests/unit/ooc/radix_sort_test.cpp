// SPDX-License-Identifier: MIT
#include "ooc/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "ooc/memory_budget.h"

namespace hewer::ooc {
namespace {

struct Record {
    std::uint64_t key;
    std::uint64_t place;
    bool operator==(const Record&) const = default;
};

TEST(RadixSort, KeepsTheOrderOfEqualKeysForAnyNumberOfThreads) {
    MemoryBudget budget(std::uint64_t{1} << 30);
    std::mt19937_64 random(1);
    for (const unsigned n_threads : {1U, 2U, 7U}) {
        Workers workers(n_threads);
        for (const std::size_t n : {0UL, 1UL, 1000UL, 100000UL}) {
            // Many equal keys; keys that differ in the upper and in the lower bits.
            for (const std::uint64_t mask : {0x3fUL, 0xffff000000000000UL, ~0UL}) {
                Array<Record> records(budget, "records", n);
                Array<Record> scratch(budget, "records", n);
                for (std::size_t i = 0; i < n; ++i) records[i] = {random() & mask, i};
                std::vector<Record> expected(records.begin(), records.end());
                std::stable_sort(expected.begin(), expected.end(),
                                 [](const Record& a, const Record& b) { return a.key < b.key; });
                radix_sort(workers, records, scratch, [](const Record& r) { return r.key; });
                ASSERT_TRUE(std::equal(records.begin(), records.end(), expected.begin())) << n;
            }
        }
    }
}

}  // namespace
}  // namespace hewer::ooc
