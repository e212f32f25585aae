// SPDX-License-Identifier: MIT
#include "cluster/block_cutter.h"

#include <algorithm>

namespace hewer::cluster {

namespace {
constexpr unsigned kRootShift = 63;
}

/// With the codes that wait, more than most_cells_ or all that are left.
void BlockCutter::cut_first() {
    const std::uint64_t* const first = waiting_.data() + begin_;
    const std::uint64_t* const last = waiting_.data() + waiting_.size();
    unsigned shift = 0;
    const std::uint64_t* end = first + 1;
    while (shift < kRootShift) {
        const unsigned wider = shift + 3;
        const std::uint64_t prefix = *first >> wider;
        if (n_cut_ > 0 && last_cut_ >> wider == prefix) break;
        const std::uint64_t* const wider_end = std::partition_point(
            end, last, [&](std::uint64_t code) { return code >> wider == prefix; });
        if (static_cast<std::uint64_t>(wider_end - first) > most_cells_) break;
        shift = wider;
        end = wider_end;
    }
    blocks_.blocks.push_back({{*first >> shift << shift, shift}, n_cut_, 0});
    n_cut_ += static_cast<std::uint64_t>(end - first);
    last_cut_ = *(end - 1);
    begin_ += static_cast<std::size_t>(end - first);
}

void BlockCutter::add(std::span<const std::uint64_t> codes) {
    blocks_.codes.append(codes);
    waiting_.insert(waiting_.end(), codes.begin(), codes.end());
    while (waiting_.size() - begin_ > most_cells_) cut_first();
    if (begin_ > waiting_.size() / 2) {
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(begin_));
        begin_ = 0;
    }
}

void BlockCutter::finish() {
    while (waiting_.size() > begin_) cut_first();
    blocks_.blocks.push_back({{}, n_cut_, 0});
}

}  // namespace hewer::cluster
