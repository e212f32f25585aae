// SPDX-License-Identifier: MIT
#include "fidelity/budget_search.h"

#include <algorithm>
#include <cmath>

namespace hewer::fidelity {

namespace {

// Steps before the bound is bracketed.
constexpr double kLeastStep = 1.5;
constexpr double kMostStep = 16;
// A bracket as narrow as this is the end.
constexpr double kNarrow = 1.04;
// Interpolation stays so far inside the bracket.
constexpr double kMargin = 0.15;
// Of the bound: a good result that is this far was repaired, or lucky, and its distance tells
// nothing of the budget that is needed. The middle is tried.
constexpr double kTight = 0.9;

}  // namespace

BudgetSearch::BudgetSearch(std::uint64_t least, std::uint64_t first, std::uint64_t most)
    : least_(std::min(least, most)), first_(std::clamp(first, least_, most)), most_(most) {}

std::optional<std::uint64_t> BudgetSearch::best() const {
    for (const auto& [budget, distance] : tries_) {
        if (distance <= bound_) return budget;
    }
    return {};
}

std::optional<std::uint64_t> BudgetSearch::next() const {
    if (tries_.empty()) return first_;
    if (tries_.size() >= kMostTries) return {};
    const auto good = std::find_if(tries_.begin(), tries_.end(),
                                   [&](const auto& t) { return t.second <= bound_; });
    if (good == tries_.end()) {
        const auto& [budget, distance] = *tries_.rbegin();
        if (budget == most_) return {};
        const double step = std::clamp(distance / bound_, kLeastStep, kMostStep);
        const double wanted = std::ceil(step * static_cast<double>(budget));
        return wanted < static_cast<double>(most_) ? static_cast<std::uint64_t>(wanted) : most_;
    }
    if (good == tries_.begin()) {
        if (good->first == least_) return {};
        const double step =
            good->second > 0 ? std::clamp(bound_ / good->second, kLeastStep, kMostStep) : kMostStep;
        return std::max(least_,
                        static_cast<std::uint64_t>(static_cast<double>(good->first) / step));
    }
    const auto bad = std::prev(good);
    const double ratio = static_cast<double>(good->first) / static_cast<double>(bad->first);
    if (ratio <= kNarrow || good->first - bad->first < 2 || good->first <= least_) return {};
    const double fall = std::log(bad->second / std::max(good->second, 1e-3 * bound_));
    const double place = good->second > kTight * bound_
                             ? 0.5
                             : std::clamp(std::log(bad->second / bound_) / std::max(fall, 1e-9),
                                          kMargin, 1 - kMargin);
    const auto between =
        static_cast<std::uint64_t>(static_cast<double>(bad->first) * std::pow(ratio, place));
    return std::clamp(between, std::max(least_, bad->first + 1), good->first - 1);
}

}  // namespace hewer::fidelity
