// SPDX-License-Identifier: MIT
/// Makes room in the memory budget by moving pages to disk.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "ooc/memory_budget.h"

namespace hewer::ooc {

/// Called by the budget when a reservation does not fit: the spool with the most pages in memory
/// loses its last ones, and so on. More than is needed at once, so that it happens rarely.
/// Thread-safe; one thread evicts at a time.
class PageEvictor {
  public:
    class Client {
      public:
        virtual ~Client() = default;
        [[nodiscard]] virtual std::uint64_t resident_bytes() const = 0;
        /// Frees about so many bytes; returns how many. 0 if it is busy.
        virtual std::uint64_t evict(std::uint64_t wanted) = 0;
    };

    /// At least this part of the limit is freed at once.
    static constexpr std::uint64_t kLeastShare = 32;

    explicit PageEvictor(MemoryBudget& budget);
    ~PageEvictor();
    PageEvictor(const PageEvictor&) = delete;
    PageEvictor& operator=(const PageEvictor&) = delete;

    void add(Client& client);
    void remove(Client& client);

  private:
    bool make_room(std::uint64_t bytes);

    MemoryBudget& budget_;
    std::mutex mutex_;
    std::vector<Client*> clients_;
};

}  // namespace hewer::ooc
