// SPDX-License-Identifier: MIT
/// The occupied cells of a grid while their sums are gathered.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <shared_mutex>
#include <utility>
#include <vector>

#include "cluster/cell_sums.h"
#include "cluster/uniform_grid.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

/// A concurrent hash table from cell keys to slots 0, 1, 2, ..., and the sums of each slot. Which
/// slot a key gets depends on the threads' timing: nothing may be derived from slot numbers.
///
/// When it holds `most_cells`, or cannot grow, it is spilled: the owner's function takes what is in
/// it, and it begins again, empty, in a new epoch in which slots of the one before mean nothing.
///
/// Memory: 136 bytes a cell for the sums (88 more with attributes, 16 with weights), 17 to 34 for
/// the table, in steps of kChunk cells; while it grows the old table is held as well.
class CellTable {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    static constexpr unsigned kChunkBits = 14;
    static constexpr std::uint32_t kChunk = 1U << kChunkBits;  ///< cells; memory grows by so many

    CellTable(ooc::Context& context, std::uint64_t expected_cells, CellExtras extras);

    /// `spill` is called with nobody admitted; afterwards the table is cleared. `is_overdue`: other
    /// reasons to spill; cheap, called by any thread.
    struct Overflow {
        std::uint64_t most_cells = kNone;
        std::function<void()> spill;
        std::function<bool()> is_overdue;
    };
    void set_overflow(Overflow overflow) { overflow_ = std::move(overflow); }
    [[nodiscard]] std::uint64_t epoch() const { return epoch_.load(std::memory_order_acquire); }
    /// New cells that a worker should ask room for at once: more would spill a small table before
    /// it is three quarters full.
    [[nodiscard]] std::uint64_t share() const;

    /// Room for `n` new cells: call before a batch of find_or_insert() and keep the result until
    /// the batch is over; the table does not move meanwhile.
    class Admission {
      public:
        Admission(CellTable& table, std::uint64_t n);
        Admission(const Admission&) = delete;
        Admission& operator=(const Admission&) = delete;
        ~Admission();

      private:
        CellTable& table_;
        std::uint64_t n_;
        std::shared_lock<std::shared_mutex> lock_;
    };

    /// The slot of `key`, a new one if the key is new. Thread-safe under an Admission.
    std::uint32_t find_or_insert(CellKey key);

    [[nodiscard]] std::uint64_t size() const { return size_.load(std::memory_order_relaxed); }
    CellSums& sums(std::uint32_t slot) { return sums_[slot >> kChunkBits][slot & kChunkMask]; }
    AttributeSums& attributes(std::uint32_t slot) {
        return attributes_[slot >> kChunkBits][slot & kChunkMask];
    }
    WeightSums& weights(std::uint32_t slot) {
        return weights_[slot >> kChunkBits][slot & kChunkMask];
    }
    [[nodiscard]] const CellExtras& extras() const { return extras_; }

    /// Calls visit(key, slot) for every cell, in no particular order. No Admission may be alive.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for_each_in(0, index_size(), visit);
    }
    /// The same for those in a part of the index, places [begin, end) of index_size(): a share of
    /// the work for a thread.
    template <typename Visit>
    void for_each_in(std::uint64_t begin, std::uint64_t end, const Visit& visit) const {
        for (std::uint64_t i = begin; i < end; ++i) {
            if (keys_[i] != 0) visit(keys_[i] - 1, ids_[i] - 1);
        }
    }
    [[nodiscard]] std::uint64_t index_size() const { return keys_.size(); }
    /// Frees the hash table; the sums stay.
    void release_index();
    /// Frees everything.
    void release();
    /// Forgets everything, and keeps the memory for what comes next: a new epoch. No Admission may
    /// be alive.
    void clear();

  private:
    static constexpr std::uint32_t kChunkMask = kChunk - 1;

    void ensure_room(std::uint64_t n_cells);
    void make_room(std::uint64_t n);
    [[nodiscard]] bool has_room(std::uint64_t n_cells) const;

    ooc::Context& context_;
    CellExtras extras_;
    std::shared_mutex mutex_;
    std::atomic<std::uint64_t> size_{0};
    std::atomic<std::uint64_t> admitted_{0};
    // Open addressing, linear probing. 0: empty; else key + 1, and id + 1 once it is known.
    ooc::Array<std::uint64_t> keys_;
    ooc::Array<std::uint32_t> ids_;
    std::vector<ooc::Array<CellSums>> sums_;
    std::vector<ooc::Array<AttributeSums>> attributes_;
    std::vector<ooc::Array<WeightSums>> weights_;
    Overflow overflow_;
    std::atomic<std::uint64_t> epoch_{0};
};

}  // namespace hewer::cluster
