// SPDX-License-Identifier: MIT
/// Buffers for the blocks in flight, used again and again.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace hewer::streaming {

/// Holds as many blocks as were ever in use at the same time. Thread-safe.
template <typename Block>
class BlockPool {
  public:
    /// A block that goes back to the pool with the end of its scope.
    class Lease {
      public:
        Lease(BlockPool& pool, std::unique_ptr<Block> block)
            : pool_(pool), block_(std::move(block)) {}
        Lease(const Lease&) = delete;
        Lease(Lease&&) noexcept = default;
        Lease& operator=(const Lease&) = delete;
        Lease& operator=(Lease&&) = delete;
        ~Lease() {
            if (!block_) return;
            const std::lock_guard lock(pool_.mutex_);
            pool_.free_.push_back(std::move(block_));
        }
        Block& operator*() const { return *block_; }
        Block* operator->() const { return block_.get(); }

      private:
        BlockPool& pool_;
        std::unique_ptr<Block> block_;
    };

    Lease lease() {
        std::unique_ptr<Block> block;
        {
            const std::lock_guard lock(mutex_);
            if (!free_.empty()) {
                block = std::move(free_.back());
                free_.pop_back();
            }
        }
        if (!block) block = std::make_unique<Block>();
        return Lease(*this, std::move(block));
    }

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<Block>> free_;
};

}  // namespace hewer::streaming
