// SPDX-License-Identifier: MIT
/// The smallest budget whose result is good enough, found by trying.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

namespace hewer::fidelity {

/// Distances fall with the budget, about as its inverse, but not smoothly: the maximum belongs to
/// one place, and that place may be hit or missed. Brackets the bound by steps of a factor, then
/// interpolates in logarithms, or halves where a good result is barely so. What is found is good;
/// that no smaller budget would be is only likely.
class BudgetSearch {
  public:
    static constexpr unsigned kMostTries = 14;

    /// Budgets from `least` to `most`, beginning with `first`.
    BudgetSearch(std::uint64_t least, std::uint64_t first, std::uint64_t most);

    /// Distances up to this are good. Before the second next().
    void set_bound(double bound) { bound_ = bound; }
    /// No budget below this can be met. Before any budget has been added that is below.
    void raise_least(std::uint64_t least) {
        least_ = std::clamp(least, least_, most_);
        first_ = std::max(first_, least_);
    }
    /// What to try; nothing if the search is over.
    [[nodiscard]] std::optional<std::uint64_t> next() const;
    void add(std::uint64_t budget, double distance) { tries_[budget] = distance; }

    /// The smallest good budget so far.
    [[nodiscard]] std::optional<std::uint64_t> best() const;

  private:
    std::uint64_t least_;
    std::uint64_t first_;
    std::uint64_t most_;
    double bound_ = 0;
    std::map<std::uint64_t, double> tries_;
};

}  // namespace hewer::fidelity
