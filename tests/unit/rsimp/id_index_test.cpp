// SPDX-License-Identifier: MIT
#include "rsimp/id_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "hewer/error.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"
#include "tests/unit/rsimp/stored_mesh.h"

namespace hewer::rsimp {
namespace {

IdIndex index_of(ooc::Context& context, const std::vector<VertexId>& ids) {
    IdIndex index(context, ids.front(), ids.back());
    for (const VertexId id : ids) index.append(id);
    return index;
}

TEST(IdIndex, RanksAndFindsAsASearchDoes) {
    const auto context = test::make_context();
    for (const std::uint64_t n : {1U, 2U, 100U, 1000U, 30000U}) {
        std::vector<VertexId> ids = test::random_ids(n, n);
        std::sort(ids.begin(), ids.end());
        const IdIndex index = index_of(*context, ids);
        EXPECT_EQ(index.size(), n);
        for (std::uint64_t i = 0; i < n; ++i) ASSERT_EQ(index.rank(ids[i]), i);
        test::Random random(5);
        std::vector<VertexId> asked{0, ids.front() - 1, ids.back() + 1, ~VertexId{0}};
        for (int i = 0; i < 2000; ++i) {
            asked.push_back(vertex_id(900 + random.below(2 * n + 300), random.below(5)));
        }
        for (const VertexId id : asked) {
            const auto it = std::lower_bound(ids.begin(), ids.end(), id);
            const auto found = index.find(id);
            ASSERT_EQ(found.has_value(), it != ids.end() && *it == id) << id;
            if (found) {
                ASSERT_EQ(*found, static_cast<std::uint64_t>(it - ids.begin()));
            }
        }
    }
}

TEST(IdIndex, BridgesClustersThatAreFarApart) {
    const auto context = test::make_context();
    const std::vector<VertexId> ids{vertex_id(7, 0), vertex_id(7, 9), vertex_id(384 + 7, 1),
                                    vertex_id(100'000, 0), vertex_id(5'000'000, 3)};
    const IdIndex index = index_of(*context, ids);
    for (std::uint64_t i = 0; i < ids.size(); ++i) EXPECT_EQ(index.rank(ids[i]), i);
    EXPECT_FALSE(index.find(vertex_id(5'000'000, 0)));
    EXPECT_FALSE(index.find(vertex_id(384 + 7, 0)));
    EXPECT_FALSE(index.find(vertex_id(7, 10)));
}

TEST(IdIndex, RefusesIdsOutOfOrder) {
    const auto context = test::make_context();
    IdIndex index(*context, vertex_id(10, 0), vertex_id(20, 0));
    index.append(vertex_id(12, 1));
    EXPECT_THROW(index.append(vertex_id(12, 1)), InternalError);
    EXPECT_THROW(index.append(vertex_id(12, 0)), InternalError);
    EXPECT_THROW(index.append(vertex_id(900, 0)), InternalError);
}

}  // namespace
}  // namespace hewer::rsimp
