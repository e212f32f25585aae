// SPDX-License-Identifier: MIT
#include "ooc/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace hewer::ooc {
namespace {

/// Counts how many of its kind there are.
class Counted {
  public:
    explicit Counted(std::atomic<int>& n) : n_(&n) { ++*n_; }
    Counted(const Counted& other) : n_(other.n_) { ++*n_; }
    Counted& operator=(const Counted&) = delete;
    ~Counted() { --*n_; }

  private:
    std::atomic<int>* n_;
};

TEST(Workers, CommitInOrderWhateverTheThreads) {
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        Workers workers(n_threads);
        std::atomic<int> n_alive{0};
        std::vector<std::uint64_t> seen;
        workers.in_order(
            1000, 5,
            [&](std::uint64_t) {
                Counted result(n_alive);
                EXPECT_LE(n_alive.load(), 2 * 5);  // each is moved once
                return result;
            },
            [&](std::uint64_t i, Counted&) { seen.push_back(i); });
        ASSERT_EQ(seen.size(), 1000U);
        for (std::uint64_t i = 0; i < 1000; ++i) EXPECT_EQ(seen[i], i);
        EXPECT_EQ(n_alive.load(), 0);
    }
}

TEST(Workers, InOrderThrowsTheFirstExceptionInOrderAndLeaksNothing) {
    for (const unsigned n_threads : {1U, 2U, 8U}) {
        for (int round = 0; round < 50; ++round) {
            Workers workers(n_threads);
            std::atomic<int> n_alive{0};
            std::uint64_t n_committed = 0;
            std::string message;
            try {
                workers.in_order(
                    100, 9,
                    [&](std::uint64_t i) {
                        // Of those under way at once, the later ones fail sooner.
                        if (i >= 50 && i % 2 == 0) throw std::runtime_error(std::to_string(i));
                        return Counted(n_alive);
                    },
                    [&](std::uint64_t i, Counted&) {
                        if (i == 51) throw std::runtime_error("commit");
                        ++n_committed;
                    });
            } catch (const std::runtime_error& e) {
                message = e.what();
            }
            EXPECT_EQ(message, "50");
            EXPECT_EQ(n_committed, 50U);
            EXPECT_EQ(n_alive.load(), 0);
        }
    }
}

TEST(Workers, InOrderStopsWhenACommitFails) {
    for (const unsigned n_threads : {1U, 4U}) {
        Workers workers(n_threads);
        std::atomic<int> n_alive{0};
        std::atomic<std::uint64_t> n_worked{0};
        EXPECT_THROW(workers.in_order(
                         1'000'000, 5,
                         [&](std::uint64_t) {
                             ++n_worked;
                             return Counted(n_alive);
                         },
                         [&](std::uint64_t i, Counted&) {
                             if (i == 10) throw std::runtime_error("commit");
                         }),
                     std::runtime_error);
        EXPECT_LE(n_worked.load(), 10U + 1 + 5);
        EXPECT_EQ(n_alive.load(), 0);
    }
}

}  // namespace
}  // namespace hewer::ooc
