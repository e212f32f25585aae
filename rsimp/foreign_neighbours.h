// SPDX-License-Identifier: MIT
/// The nearest points of other parts, for points in memory.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hewer/types.h"

namespace hewer::rsimp {

/// FLANN's exact tree (KDTreeSingleIndex, Muja & Lowe 2009) over points of several parts. A search
/// asks for a few neighbours and for four times as many until they are too far. In double
/// precision; equal input gives equal answers, of two equally far points the one that came first
/// among those that the tree returned. Memory: kBytesPerPoint for each.
class ForeignNeighbours {
  public:
    static constexpr std::uint64_t kBytesPerPoint = 96;

    /// `parts` of the points, in their order.
    ForeignNeighbours(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& parts);
    ~ForeignNeighbours();

    /// The nearest point of another part than that of `point`, if it is within `reach`, and of each
    /// further part the nearest that is no more than twice as far and within `reach`: where several
    /// parts meet, all of them.
    void nearest(std::uint32_t point, double reach, std::vector<std::uint32_t>& neighbours);

  private:
    class Tree;
    const std::vector<Vec3>& points_;
    const std::vector<std::uint32_t>& parts_;
    std::unique_ptr<Tree> tree_;
    std::vector<std::size_t> found_;
    std::vector<double> distances_;
};

}  // namespace hewer::rsimp
