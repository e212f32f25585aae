// SPDX-License-Identifier: MIT
/// One limit for the whole process: what grows with input or output reserves its bytes here first.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace hewer::ooc {

class MemoryBudget;

/// Bytes taken from a budget, given back on destruction. Move-only.
class Reservation {
  public:
    Reservation() = default;
    Reservation(const Reservation&) = delete;
    Reservation& operator=(const Reservation&) = delete;
    Reservation(Reservation&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    Reservation& operator=(Reservation&& other) noexcept;
    ~Reservation() { release(); }

    void release() noexcept;
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  private:
    friend class MemoryBudget;
    Reservation(MemoryBudget* budget, std::uint64_t bytes) : budget_(budget), bytes_(bytes) {}
    MemoryBudget* budget_ = nullptr;
    std::uint64_t bytes_ = 0;
};

/// Thread-safe. The object must outlive its reservations.
class MemoryBudget {
  public:
    /// `limit` bytes for the process, of which `fixed` are taken at once for what does not grow:
    /// code, stacks, libraries.
    explicit MemoryBudget(std::uint64_t limit, std::uint64_t fixed = kFixedBytes);

    /// What does not fit makes the reclaimer free memory first. Throws OutOfMemoryBudget, naming
    /// `what`, the bytes asked, used and the limit.
    Reservation reserve(std::string_view what, std::uint64_t bytes);

    /// For memory that only saves time: nothing if it is not free.
    std::optional<Reservation> try_reserve(std::uint64_t bytes);

    /// Called with the bytes that a reservation lacks; false if it can free nothing. Set by the
    /// owner, before threads reserve.
    void set_reclaimer(std::function<bool(std::uint64_t)> reclaim) {
        reclaim_ = std::move(reclaim);
    }

    [[nodiscard]] std::uint64_t limit() const { return limit_; }
    [[nodiscard]] std::uint64_t used() const { return used_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t available() const;
    /// Most that was reserved at once since the last reset_peak().
    [[nodiscard]] std::uint64_t peak() const { return peak_.load(std::memory_order_relaxed); }
    void reset_peak() { peak_.store(used(), std::memory_order_relaxed); }

    /// Code, libraries, stacks and allocator slack of a process with a few threads; measured.
    static constexpr std::uint64_t kFixedBytes = 16ULL << 20;

  private:
    friend class Reservation;
    void give_back(std::uint64_t bytes) noexcept;
    std::uint64_t limit_;
    std::atomic<std::uint64_t> used_;
    std::atomic<std::uint64_t> peak_;
    std::function<bool(std::uint64_t)> reclaim_;
};

/// The limit that applies when the user names none: the tightest memory limit of the control groups
/// that this process is in (v1 and v2), else half of the machine's memory.
std::uint64_t default_memory_limit();

}  // namespace hewer::ooc
