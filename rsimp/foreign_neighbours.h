// SPDX-License-Identifier: MIT
/// The nearest points of other parts, for points in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "hewer/types.h"
#include "rsimp/point_tree.h"

namespace hewer::rsimp {

/// A PointTree over points of several parts. A search asks for a few neighbours and for four times
/// as many until they are too far; of two equally far points it takes the one that came first among
/// those that the tree returned. Memory: kBytesPerPoint for each.
class ForeignNeighbours {
  public:
    static constexpr std::uint64_t kBytesPerPoint = PointTree::kBytesPerPoint;

    /// `parts` of the points, in their order.
    ForeignNeighbours(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& parts);

    /// The nearest point of another part than that of `point`, if it is within `reach`, and of each
    /// further part the nearest that is no more than twice as far and within `reach`: where several
    /// parts meet, all of them.
    void nearest(std::uint32_t point, double reach, std::vector<std::uint32_t>& neighbours);

  private:
    const std::vector<Vec3>& points_;
    const std::vector<std::uint32_t>& parts_;
    PointTree tree_;
    std::vector<std::size_t> found_;
    std::vector<double> distances_;
};

}  // namespace hewer::rsimp
