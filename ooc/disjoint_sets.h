// SPDX-License-Identifier: MIT
/// Which of many things hang together (union-find), in memory that is accounted for.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "ooc/array.h"

namespace hewer::ooc {

/// The numbers 0 .. n - 1, each at first a set of its own. A set is named by its smallest number,
/// so names do not depend on the order of the joins. One thread. Memory: 4 bytes a number, 8 if
/// there are more than 2^32 of them.
class DisjointSets {
  public:
    DisjointSets() = default;
    /// Throws OutOfMemoryBudget naming `what`.
    DisjointSets(MemoryBudget& budget, std::string_view what, std::uint64_t n) {
        if (n - (n > 0) <= std::numeric_limits<std::uint32_t>::max()) {
            small_ = Array<std::uint32_t>(budget, what, n);
        } else {
            large_ = Array<std::uint64_t>(budget, what, n);
        }
        separate();
    }

    [[nodiscard]] std::uint64_t size() const { return small_.size() + large_.size(); }

    /// Name of the set of `i`.
    std::uint64_t find(std::uint64_t i) {
        return large_.empty() ? find_in(small_, i) : find_in(large_, i);
    }
    /// True if two sets became one.
    bool join(std::uint64_t a, std::uint64_t b) {
        return large_.empty() ? join_in(small_, a, b) : join_in(large_, a, b);
    }
    /// Every number is a set of its own again.
    void separate() {
        for (std::uint64_t i = 0; i < small_.size(); ++i) small_[i] = static_cast<std::uint32_t>(i);
        for (std::uint64_t i = 0; i < large_.size(); ++i) large_[i] = i;
    }

  private:
    template <typename Id>
    static std::uint64_t find_in(Array<Id>& parent, std::uint64_t i) {
        while (parent[i] != i) {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        return i;
    }
    template <typename Id>
    static bool join_in(Array<Id>& parent, std::uint64_t a, std::uint64_t b) {
        a = find_in(parent, a);
        b = find_in(parent, b);
        if (a == b) return false;
        if (a < b) std::swap(a, b);
        parent[a] = static_cast<Id>(b);
        return true;
    }

    Array<std::uint32_t> small_;
    Array<std::uint64_t> large_;
};

}  // namespace hewer::ooc
