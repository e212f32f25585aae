// SPDX-License-Identifier: MIT
/// Triangles sorted into boxes come out once each, however the threads that read them are delayed.
#include "cluster/triangle_partition.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace hewer::cluster {

namespace {

/// One number a triangle, spread over all boxes: few a box, so that a thread is overtaken by
/// several boxes while it reads its own.
LatticeTriangle numbered(std::uint32_t i) {
    return {{{i << 30, (i >> 2) << 30, (i >> 4) << 30}, {i, 0, 0}, {0, 0, 0}}};
}

}  // namespace

TEST(TrianglePartition, GivesEachTriangleOnceToThreadsThatOvertakeEachOther) {
    constexpr std::uint32_t kTriangles = 20'000;
    constexpr unsigned kThreads = 8;
    for (unsigned repetition = 0; repetition < 40; ++repetition) {
        ooc::Context context({.memory_bytes = 64 << 20,
                              .n_threads = kThreads,
                              .page_bytes = 4 << 10,
                              .spills_at_once = true});
        TrianglePartition partition(context);
        for (std::uint32_t i = 0; i < kTriangles; ++i) partition.add(numbered(i));
        partition.finish();

        std::vector<std::vector<std::uint32_t>> taken(kThreads);
        std::vector<std::thread> threads;
        threads.reserve(kThreads);
        for (auto& mine : taken) {
            threads.emplace_back([&partition, &mine] {
                std::vector<LatticeTriangle> triangles;
                while (partition.next(triangles)) {
                    for (const auto& t : triangles) mine.push_back(t[1][0]);
                }
            });
        }
        for (auto& thread : threads) thread.join();
        std::vector<unsigned> times(kTriangles);
        for (const auto& mine : taken) {
            for (const std::uint32_t i : mine) ++times.at(i);
        }
        EXPECT_EQ(times, std::vector<unsigned>(kTriangles, 1));
    }
}

}  // namespace hewer::cluster
