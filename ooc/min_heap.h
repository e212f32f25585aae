// SPDX-License-Identifier: MIT
/// A queue by priority whose bytes are accounted for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "ooc/array.h"

namespace hewer::ooc {

/// Yields the smallest record first; equal ones in no particular order. Doubles when it is full;
/// both copies are reserved meanwhile. Throws OutOfMemoryBudget.
template <typename T>
class MinHeap {
  public:
    /// `what` names the records in messages.
    MinHeap(MemoryBudget& budget, std::string what) : budget_(&budget), what_(std::move(what)) {}

    [[nodiscard]] bool empty() const { return size_ == 0; }
    /// Precondition: not empty.
    [[nodiscard]] const T& top() const { return records_[0]; }
    void pop() {
        std::pop_heap(records_.begin(), records_.begin() + size_, later);
        --size_;
    }
    void push(const T& record) {
        if (size_ == records_.size()) {
            Array<T> larger(*budget_, what_, std::max(kLeast, 2 * size_));
            std::copy(records_.begin(), records_.end(), larger.begin());
            records_ = std::move(larger);
        }
        records_[size_++] = record;
        std::push_heap(records_.begin(), records_.begin() + size_, later);
    }

  private:
    static constexpr std::uint64_t kLeast = 256;
    static bool later(const T& a, const T& b) { return b < a; }
    MemoryBudget* budget_;
    std::string what_;
    Array<T> records_;
    std::uint64_t size_ = 0;
};

}  // namespace hewer::ooc
