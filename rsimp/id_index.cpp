// SPDX-License-Identifier: MIT
#include "rsimp/id_index.h"

#include <algorithm>

#include "hewer/error.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kWordBits = 64;
constexpr std::uint64_t kCountBits = 9;  // up to 5 * 64
constexpr std::uint64_t kLeastFans = 512;

/// std::popcount() is a call where the processor need not have an instruction for it.
std::uint64_t n_bits(std::uint64_t x) {
    constexpr std::uint64_t kPairs = 0x5555555555555555;
    constexpr std::uint64_t kNibbles = 0x3333333333333333;
    constexpr std::uint64_t kBytes = 0x0f0f0f0f0f0f0f0f;
    x -= x >> 1 & kPairs;
    x = (x & kNibbles) + (x >> 2 & kNibbles);
    return ((x + (x >> 4)) & kBytes) * 0x0101010101010101 >> 56;
}

bool is_first_fan(VertexId id) {
    return id == vertex_id(cluster_of(id), 0);
}

}  // namespace

IdIndex::IdIndex(ooc::Context& context, VertexId first, VertexId last)
    : budget_(&context.budget()),
      first_cluster_(cluster_of(first)),
      lines_(context.budget(), "vertex index",
             (cluster_of(last) - first_cluster_) / (kWords * kWordBits) + 2) {}

void IdIndex::append(VertexId id) {
    const std::uint64_t cluster = cluster_of(id) - first_cluster_;
    const std::uint64_t line = cluster / (kWords * kWordBits);
    if ((size_ > 0 && id <= last_) || line + 1 >= lines_.size()) {
        throw InternalError("vertex index: ids out of order");
    }
    while (line_ < line) {
        ++line_;
        lines_[line_].before = size_;
        lines_[line_].fans = n_fans_;
    }
    if (is_first_fan(id)) {
        const std::uint64_t bit = cluster % (kWords * kWordBits);
        lines_[line].bits[bit / kWordBits] |= std::uint64_t{1} << (bit % kWordBits);
        for (std::uint64_t w = bit / kWordBits + 1; w < kWords; ++w) {
            lines_[line].counts += std::uint64_t{1} << (w * kCountBits);
        }
    } else {
        if (n_fans_ == fans_.size()) {
            ooc::Array<VertexId> larger(*budget_, "vertex index",
                                        std::max(kLeastFans, 2 * n_fans_));
            std::copy(fans_.begin(), fans_.end(), larger.begin());
            fans_ = std::move(larger);
        }
        fans_[n_fans_++] = id;
    }
    lines_[line + 1].fans = n_fans_;
    ++size_;
    last_ = id;
}

const VertexId* IdIndex::first_not_below(std::uint64_t line, VertexId id) const {
    return std::lower_bound(fans_.begin() + lines_[line].fans,
                            fans_.begin() + lines_[line + 1].fans, id);
}

std::uint64_t IdIndex::rank(VertexId id) const {
    const std::uint64_t cluster = cluster_of(id) - first_cluster_;
    const std::uint64_t l = cluster / (kWords * kWordBits);
    const Line& line = lines_[l];
    const std::uint64_t bit = cluster % (kWords * kWordBits);
    const std::uint64_t w = bit / kWordBits;
    std::uint64_t rank =
        line.before + (line.counts >> (w * kCountBits) & ((std::uint64_t{1} << kCountBits) - 1));
    // A further fan comes after the first one of its own cluster.
    const std::uint64_t own = std::uint64_t{1} << (bit % kWordBits);
    const std::uint64_t lower = is_first_fan(id) ? own - 1 : (own - 1) | own;
    rank += n_bits(line.bits[w] & lower);
    if (lines_[l + 1].fans > line.fans) {
        rank += static_cast<std::uint64_t>(first_not_below(l, id) - fans_.begin()) - line.fans;
    }
    return rank;
}

std::optional<std::uint64_t> IdIndex::find(VertexId id) const {
    if (size_ == 0 || id > last_ || cluster_of(id) < first_cluster_) return {};
    const std::uint64_t cluster = cluster_of(id) - first_cluster_;
    const std::uint64_t l = cluster / (kWords * kWordBits);
    const std::uint64_t bit = cluster % (kWords * kWordBits);
    const bool is_there = is_first_fan(id)
                              ? (lines_[l].bits[bit / kWordBits] >> (bit % kWordBits) & 1) != 0
                              : std::binary_search(fans_.begin() + lines_[l].fans,
                                                   fans_.begin() + lines_[l + 1].fans, id);
    if (!is_there) return {};
    return rank(id);
}

}  // namespace hewer::rsimp
