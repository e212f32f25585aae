// SPDX-License-Identifier: MIT
#include "rsimp/foreign_neighbours.h"

#include <algorithm>

namespace hewer::rsimp {

namespace {

constexpr std::size_t kFirstAsked = 8;
constexpr std::size_t kMoreAsked = 4;
// Of further parts: so many times the distance of the nearest.
constexpr double kFarther = 2;

}  // namespace

ForeignNeighbours::ForeignNeighbours(const std::vector<Vec3>& points,
                                     const std::vector<std::uint32_t>& parts)
    : points_(points), parts_(parts), tree_(points) {}

void ForeignNeighbours::nearest(std::uint32_t point, double reach,
                                std::vector<std::uint32_t>& neighbours) {
    for (std::size_t n = kFirstAsked;; n *= kMoreAsked) {
        n = std::min(n, points_.size());
        tree_.nearest(points_[point], n, found_, distances_);
        neighbours.clear();
        double most = reach * reach;
        for (std::size_t i = 0; i < n; ++i) {
            if (distances_[i] > most) return;
            const auto other = static_cast<std::uint32_t>(found_[i]);
            const auto is_same_part = [&](std::uint32_t p) { return parts_[p] == parts_[other]; };
            if (is_same_part(point) ||
                std::any_of(neighbours.begin(), neighbours.end(), is_same_part)) {
                continue;
            }
            if (neighbours.empty()) most = std::min(most, kFarther * kFarther * distances_[i]);
            neighbours.push_back(other);
        }
        if (n == points_.size()) return;
    }
}

}  // namespace hewer::rsimp
