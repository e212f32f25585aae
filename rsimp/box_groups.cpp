// SPDX-License-Identifier: MIT
#include "rsimp/box_groups.h"

#include <algorithm>

namespace hewer::rsimp {

std::vector<std::size_t> group_boxes(std::span<const cluster::OctreeBox> boxes,
                                     std::span<const std::uint64_t> counts, std::uint64_t most) {
    struct Range {
        std::size_t first;
        std::size_t last;
        unsigned shift;
    };
    std::vector<std::uint64_t> sum(boxes.size() + 1);
    for (std::size_t i = 0; i < boxes.size(); ++i) sum[i + 1] = sum[i] + counts[i];
    std::vector<std::size_t> groups;
    constexpr unsigned kRootShift = 63;
    std::vector<Range> open{{0, boxes.size(), kRootShift}};
    while (!open.empty()) {
        const Range range = open.back();
        open.pop_back();
        if (range.first == range.last) continue;
        if (range.last - range.first == 1 || sum[range.last] - sum[range.first] <= most) {
            groups.push_back(range.first);
            continue;
        }
        const unsigned shift = range.shift - 3;
        std::size_t last = range.last;
        for (unsigned octant = 8; octant-- > 0;) {  // pushed last to first: popped in order
            const auto begin = std::partition_point(
                boxes.begin() + static_cast<std::ptrdiff_t>(range.first),
                boxes.begin() + static_cast<std::ptrdiff_t>(last),
                [&](const cluster::OctreeBox& box) { return (box.code >> shift & 7) < octant; });
            const auto first = static_cast<std::size_t>(begin - boxes.begin());
            open.push_back({first, last, shift});
            last = first;
        }
    }
    groups.push_back(boxes.size());
    return groups;
}

std::size_t IdRanges::find(VertexId id) const {
    const auto it = std::upper_bound(first_.begin(), first_.end() - 1, id);
    return static_cast<std::size_t>(it - first_.begin()) - 1;
}

}  // namespace hewer::rsimp
