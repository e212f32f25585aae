// SPDX-License-Identifier: MIT
/// A large array whose bytes are accounted for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "ooc/memory_budget.h"

namespace hewer::ooc {

/// Pages from the system, zeroed, returned to it on release (so that what one stage gives back, the
/// next one can have: the allocator's free lists would keep it resident). Null for 0 bytes.
/// Throws std::bad_alloc.
void* map_pages(std::uint64_t bytes);
void unmap_pages(void* address, std::uint64_t bytes) noexcept;

/// A fixed number of trivially copyable elements, zero-initialised, reserved in a budget.
/// Move-only.
template <typename T>
class Array {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  public:
    Array() = default;
    /// Throws OutOfMemoryBudget naming `what`.
    Array(MemoryBudget& budget, std::string_view what, std::uint64_t size)
        : reservation_(budget.reserve(what, size * sizeof(T))),
          data_(static_cast<T*>(map_pages(size * sizeof(T)))),
          size_(size) {}
    /// Nothing if that much memory is not free.
    static std::optional<Array> try_make(MemoryBudget& budget, std::uint64_t size) {
        auto reservation = budget.try_reserve(size * sizeof(T));
        if (!reservation) return std::nullopt;
        Array array;
        array.reservation_ = std::move(*reservation);
        array.data_ = static_cast<T*>(map_pages(size * sizeof(T)));
        array.size_ = size;
        return array;
    }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    Array(Array&& other) noexcept
        : reservation_(std::move(other.reservation_)),
          data_(std::exchange(other.data_, nullptr)),
          size_(std::exchange(other.size_, 0)) {}
    Array& operator=(Array&& other) noexcept {
        if (this != &other) {
            release();
            reservation_ = std::move(other.reservation_);
            data_ = std::exchange(other.data_, nullptr);
            size_ = std::exchange(other.size_, 0);
        }
        return *this;
    }
    ~Array() { release(); }

    void release() noexcept {
        unmap_pages(data_, size_ * sizeof(T));
        data_ = nullptr;
        size_ = 0;
        reservation_.release();
    }

    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    T* data() { return data_; }
    [[nodiscard]] const T* data() const { return data_; }
    T& operator[](std::uint64_t i) { return data_[i]; }
    const T& operator[](std::uint64_t i) const { return data_[i]; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    [[nodiscard]] const T* begin() const { return data_; }
    [[nodiscard]] const T* end() const { return data_ + size_; }
    std::span<T> span() { return {data_, size_}; }
    [[nodiscard]] std::span<const T> span() const { return {data_, size_}; }

  private:
    Reservation reservation_;
    T* data_ = nullptr;
    std::uint64_t size_ = 0;
};

}  // namespace hewer::ooc
