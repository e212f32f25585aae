// SPDX-License-Identifier: MIT
#include "rsimp/lod_parents.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/clustered_mesh.h"

namespace hewer::rsimp {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

VertexId id(std::uint64_t cluster) {
    return vertex_id(cluster, 0);
}

LodParents parents(const std::vector<VertexId>& fine,
                   const std::vector<std::pair<VertexId, VertexId>>& merges,
                   const std::vector<VertexId>& coarse) {
    const auto context = test::make_context();
    ooc::Spool<VertexId> a(*context, "fine");
    ooc::Spool<VertexId> b(*context, "coarse");
    a.append(fine);
    b.append(coarse);
    return find_parents(*context, a, merges, b);
}

TEST(FindParents, FollowsMergesInOrder) {
    const std::vector<VertexId> fine{id(1), id(2), id(3), id(4), id(5)};
    // 1 -> 2 -> 4; the others stay.
    EXPECT_EQ(parents(fine, {{id(1), id(2)}, {id(2), id(4)}}, {id(3), id(4), id(5)}),
              (LodParents{1, 1, 0, 1, 2}));
    // What 4 got before it went itself goes with it.
    EXPECT_EQ(parents(fine, {{id(2), id(4)}, {id(1), id(4)}, {id(4), id(5)}}, {id(3), id(5)}),
              (LodParents{1, 1, 0, 1, 1}));
}

TEST(FindParents, VerticesMadeOnTheWayPassOnWhatTheyGot) {
    const VertexId made = vertex_id(2, 7);
    EXPECT_EQ(parents({id(1), id(2)}, {{id(1), made}, {id(2), made}}, {made}), (LodParents{0, 0}));
    EXPECT_EQ(parents({id(1), id(2)}, {{id(1), made}, {made, id(9)}}, {id(2), id(9)}),
              (LodParents{1, 0}));
    // An id that comes back is not what it was.
    EXPECT_EQ(parents({id(1), id(2)}, {{id(1), id(2)}, {id(2), made}, {made, id(1)}}, {id(1)}),
              (LodParents{0, 0}));
}

TEST(FindParents, WhatIsLeftOutHasNone) {
    EXPECT_EQ(parents({id(1), id(2), id(3)}, {{id(1), id(2)}}, {id(3)}),
              (LodParents{kNone, kNone, 0}));
    EXPECT_EQ(parents({id(1)}, {}, {}), (LodParents{kNone}));
    EXPECT_EQ(parents({}, {}, {id(1)}), (LodParents{}));
}

}  // namespace
}  // namespace hewer::rsimp
