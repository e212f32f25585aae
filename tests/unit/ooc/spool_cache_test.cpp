// SPDX-License-Identifier: MIT
#include "ooc/spool_cache.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::ooc {

TEST(SpoolCache, GivesTheRecordsOfTheSpoolWhereverTheyAre) {
    const auto context = test::make_context();
    // More than the cache holds, and no whole number of lines.
    const std::uint64_t n = 3 * SpoolCache<std::uint32_t>::kBytes / sizeof(std::uint32_t) + 5;
    Spool<std::uint32_t> spool(*context, "numbers");
    for (std::uint32_t i = 0; i < n; ++i) spool.push(7 * i);
    SpoolCache<std::uint32_t> cache(spool);
    test::Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const std::uint64_t at = i % 2 == 0 ? random.below(n) : n - 1 - random.below(100);
        ASSERT_EQ(cache.at(at), 7 * static_cast<std::uint32_t>(at));
    }
}

TEST(SpoolCache, SeesWhatASpoolHasGrownBy) {
    const auto context = test::make_context();
    Spool<std::uint32_t> spool(*context, "numbers");
    SpoolCache<std::uint32_t> cache(spool, 4);
    for (std::uint32_t i = 0; i < 20000; ++i) {
        spool.push(3 * i);
        ASSERT_EQ(cache.at(i), 3 * i);
        ASSERT_EQ(cache.at(i / 2), 3 * (i / 2));
    }
}

}  // namespace hewer::ooc
