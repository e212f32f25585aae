// SPDX-License-Identifier: MIT
#include "measure/triangle_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {

// Groups up to this are split depth-first by one thread: 1.1 MiB, about a second-level cache.
constexpr std::uint64_t kSerialGroup = 1 << 15;

/// Three times the centroid.
std::int64_t centroid3(const LatticeTriangle& t, std::size_t axis) {
    return std::int64_t{t[0][axis]} + t[1][axis] + t[2][axis];
}

std::size_t longest_axis(std::span<const LatticeTriangle> group) {
    std::array<std::int64_t, 3> lo{};
    std::array<std::int64_t, 3> hi{};
    lo.fill(std::numeric_limits<std::int64_t>::max());
    hi.fill(std::numeric_limits<std::int64_t>::min());
    for (const LatticeTriangle& t : group) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int64_t x = centroid3(t, i);
            lo[i] = std::min(lo[i], x);
            hi[i] = std::max(hi[i], x);
        }
    }
    std::size_t best = 0;
    for (std::size_t i = 1; i < 3; ++i) {
        if (hi[i] - lo[i] > hi[best] - lo[best]) best = i;
    }
    return best;
}

/// Puts the `half` triangles that come first along the longest axis in front.
void split(std::span<LatticeTriangle> group, std::uint64_t half) {
    if (group.size() <= half) return;
    const std::size_t axis = longest_axis(group);
    // Ties are broken by all coordinates, so that the two sides are the same sets whatever order
    // the group came in.
    std::nth_element(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(half), group.end(),
                     [axis](const LatticeTriangle& s, const LatticeTriangle& t) {
                         const std::int64_t x = centroid3(s, axis);
                         const std::int64_t y = centroid3(t, axis);
                         return x != y ? x < y : s < t;
                     });
}

void split_all(std::span<LatticeTriangle> group, std::uint64_t capacity, std::uint64_t leaf) {
    if (capacity == leaf) {
        std::sort(group.begin(), group.end());
        return;
    }
    const std::uint64_t half = capacity / 2;
    split(group, half);
    const std::uint64_t n_front = std::min<std::uint64_t>(half, group.size());
    split_all(group.first(n_front), half, leaf);
    if (n_front < group.size()) split_all(group.subspan(n_front), half, leaf);
}

}  // namespace

void order_by_median_splits(ooc::Context& context, std::span<LatticeTriangle> triangles,
                            std::uint64_t leaf) {
    const std::uint64_t n = triangles.size();
    const auto group = [&](std::uint64_t i, std::uint64_t capacity) {
        return triangles.subspan(i * capacity, std::min(capacity, n - i * capacity));
    };
    std::uint64_t capacity = leaf;
    while (capacity < n) capacity *= 2;
    for (; capacity > kSerialGroup && capacity > leaf; capacity /= 2) {
        context.workers().for_ranges((n + capacity - 1) / capacity, 1,
                                     [&](std::uint64_t begin, std::uint64_t end) {
                                         for (std::uint64_t i = begin; i < end; ++i) {
                                             context.check_stop();
                                             split(group(i, capacity), capacity / 2);
                                         }
                                     });
    }
    context.workers().for_ranges((n + capacity - 1) / capacity, 1,
                                 [&](std::uint64_t begin, std::uint64_t end) {
                                     for (std::uint64_t i = begin; i < end; ++i) {
                                         const auto part = group(i, capacity);
                                         split_all(part, capacity, leaf);
                                         context.advance(part.size());
                                     }
                                 });
}

}  // namespace hewer::measuring
