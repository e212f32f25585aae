// SPDX-License-Identifier: MIT
#include "cluster/cell_table.h"

#include <algorithm>
#include <bit>
#include <mutex>
#include <type_traits>
#include <utility>

#include "cluster/hash.h"
#include "hewer/error.h"

namespace hewer::cluster {

namespace {

// Share of the table that may be used; probes stay short below it.
constexpr double kLoad = 0.7;

std::uint64_t capacity_for(std::uint64_t n_cells) {
    return std::bit_ceil(static_cast<std::uint64_t>(static_cast<double>(n_cells) / kLoad) + 1);
}

}  // namespace

CellTable::CellTable(ooc::Context& context, std::uint64_t expected_cells, CellExtras extras)
    : context_(context), extras_(extras) {
    ensure_room(expected_cells);
}

bool CellTable::has_room(std::uint64_t n_cells) const {
    return n_cells <= sums_.size() * kChunk &&
           static_cast<double>(n_cells) <= kLoad * static_cast<double>(keys_.size());
}

void CellTable::ensure_room(std::uint64_t n_cells) {
    if (n_cells >= kNone) {
        throw InvalidArgument(
            "the grid has more than 4,294,967,294 occupied cells; use a larger cell");
    }
    if (static_cast<double>(n_cells) > kLoad * static_cast<double>(keys_.size())) {
        const std::uint64_t capacity = capacity_for(n_cells);
        ooc::Array<std::uint64_t> keys(context_.budget(), "cell index", capacity);
        ooc::Array<std::uint32_t> ids(context_.budget(), "cell index", capacity);
        for (std::uint64_t i = 0; i < keys_.size(); ++i) {
            if (keys_[i] == 0) continue;
            std::uint64_t j = scattered(keys_[i]) & (capacity - 1);
            while (keys[j] != 0) j = (j + 1) & (capacity - 1);
            keys[j] = keys_[i];
            ids[j] = ids_[i];
        }
        keys_ = std::move(keys);
        ids_ = std::move(ids);
    }
    while (sums_.size() * kChunk < n_cells) {
        sums_.emplace_back(context_.budget(), "cell sums", kChunk);
        if (extras_.attributes) {
            attributes_.emplace_back(context_.budget(), "cell attributes", kChunk);
        }
        if (extras_.weights) weights_.emplace_back(context_.budget(), "cell weights", kChunk);
    }
}

void CellTable::release() {
    release_index();
    sums_.clear();
    attributes_.clear();
    weights_.clear();
    size_ = 0;
}

void CellTable::clear() {
    std::fill(keys_.begin(), keys_.end(), 0);
    std::fill(ids_.begin(), ids_.end(), 0);
    const auto zero = [&](auto& chunks) {
        std::uint64_t left = size();
        for (auto& chunk : chunks) {
            const std::uint64_t n = std::min<std::uint64_t>(left, kChunk);
            std::fill(chunk.begin(), chunk.begin() + n,
                      typename std::remove_reference_t<decltype(chunk[0])>{});
            left -= n;
        }
    };
    zero(sums_);
    zero(attributes_);
    zero(weights_);
    size_ = 0;
    epoch_.fetch_add(1, std::memory_order_release);
}

std::uint64_t CellTable::share() const {
    constexpr std::uint64_t kLeast = 96;  // a few triangles, or nothing would ever be done
    constexpr std::uint64_t kMost = 3 << 12;
    return std::clamp<std::uint64_t>(overflow_.most_cells / (4 * context_.n_threads()), kLeast,
                                     kMost);
}

/// Nobody is admitted.
void CellTable::make_room(std::uint64_t n) {
    const bool is_overdue = overflow_.is_overdue && overflow_.is_overdue();
    const bool may_spill = overflow_.spill && size() > 0;
    if (may_spill && (is_overdue || size() + 2 * n > overflow_.most_cells)) {
        overflow_.spill();
        clear();
        return;
    }
    // Twice the room, so that growing stays rare.
    if (has_room(size() + 2 * n)) return;
    try {
        ensure_room(
            std::max(size() + 2 * n, std::min(size() + size() / 4 + 4 * n, overflow_.most_cells)));
    } catch (const OutOfMemoryBudget&) {
        if (!may_spill) throw;
        overflow_.spill();
        clear();
    }
}

void CellTable::release_index() {
    keys_.release();
    ids_.release();
}

CellTable::Admission::Admission(CellTable& table, std::uint64_t n) : table_(table), n_(n) {
    for (;;) {
        {
            std::shared_lock lock(table.mutex_);
            const std::uint64_t admitted = table.admitted_.fetch_add(n) + n;
            const std::uint64_t wanted = table.size() + admitted;
            const bool is_overdue =
                table.overflow_.is_overdue && table.size() > 0 && table.overflow_.is_overdue();
            const bool is_full = wanted > table.overflow_.most_cells && table.size() > 0;
            if (!is_overdue && !is_full && table.has_room(wanted)) {
                lock_ = std::move(lock);
                return;
            }
            table.admitted_.fetch_sub(n);
        }
        const std::unique_lock lock(table.mutex_);
        table.make_room(n);
    }
}

CellTable::Admission::~Admission() {
    table_.admitted_.fetch_sub(n_);
}

std::uint32_t CellTable::find_or_insert(CellKey key) {
    const std::uint64_t wanted = key + 1;
    const std::uint64_t mask = keys_.size() - 1;
    for (std::uint64_t i = scattered(wanted) & mask;; i = (i + 1) & mask) {
        std::atomic_ref<std::uint64_t> slot_key(keys_[i]);
        std::atomic_ref<std::uint32_t> slot_id(ids_[i]);
        std::uint64_t found = slot_key.load(std::memory_order_relaxed);
        if (found == 0) {
            if (slot_key.compare_exchange_strong(found, wanted, std::memory_order_relaxed)) {
                const auto id =
                    static_cast<std::uint32_t>(size_.fetch_add(1, std::memory_order_relaxed));
                slot_id.store(id + 1, std::memory_order_release);
                return id;
            }
        }
        if (found == wanted) {
            std::uint32_t id = slot_id.load(std::memory_order_acquire);
            while (id == 0) id = slot_id.load(std::memory_order_acquire);
            return id - 1;
        }
    }
}

}  // namespace hewer::cluster
