// SPDX-License-Identifier: MIT
/// How many blocks may be at work at the same time, and the memory for them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/parallel.h"

namespace hewer::rsimp {

/// The most that one block has: what a worker must have room for.
struct LargestBlock {
    explicit LargestBlock(const cluster::CellBlocks& blocks);
    std::uint64_t n_cells = 0;
    std::uint64_t n_faces = 0;
};

/// Two blocks for each thread, so that no thread waits for a slow block before its own; fewer where
/// they would take more than a quarter of the limit; one at least. The number does not show in any
/// result.
class BlocksInFlight {
  public:
    /// `bytes` for each block. Throws OutOfMemoryBudget if there is no room for one.
    BlocksInFlight(ooc::Context& context, std::string_view what, std::uint64_t bytes);

    /// do_work(i, work) for i in [0, n) on all threads, then commit(i, work) one after the other,
    /// in order. A Work is used again and again, so that its memory is.
    template <typename Work, typename DoWork, typename Commit>
    void sweep(std::uint64_t n, const DoWork& do_work, const Commit& commit) const {
        std::mutex mutex;
        std::vector<std::unique_ptr<Work>> idle;
        const auto take = [&]() -> std::unique_ptr<Work> {
            const std::lock_guard lock(mutex);
            if (idle.empty()) return std::make_unique<Work>();
            std::unique_ptr<Work> work = std::move(idle.back());
            idle.pop_back();
            return work;
        };
        context_.workers().in_order(
            n, most_alive_,
            [&](std::uint64_t i) {
                context_.check_stop();
                std::unique_ptr<Work> work = take();
                do_work(i, *work);
                return work;
            },
            [&](std::uint64_t i, std::unique_ptr<Work>& work) {
                commit(i, *work);
                const std::lock_guard lock(mutex);
                idle.push_back(std::move(work));
            });
    }

  private:
    ooc::Context& context_;
    std::size_t most_alive_ = 1;
    ooc::Reservation reservation_;
};

}  // namespace hewer::rsimp
