// SPDX-License-Identifier: MIT
/// The nearest of many points, for points in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hewer/types.h"

namespace hewer::rsimp {

/// FLANN's exact tree (KDTreeSingleIndex, Muja & Lowe 2009). In double precision; equal input gives
/// equal answers. Memory: kBytesPerPoint for each.
class PointTree {
  public:
    static constexpr std::uint64_t kBytesPerPoint = 96;

    explicit PointTree(const std::vector<Vec3>& points);
    ~PointTree();
    PointTree(const PointTree&) = delete;
    PointTree& operator=(const PointTree&) = delete;

    /// The `n` nearest ones, no more than there are, and the squares of their distances.
    void nearest(const Vec3& at, std::size_t n, std::vector<std::size_t>& found,
                 std::vector<double>& squared);

  private:
    class Index;
    std::unique_ptr<Index> index_;
};

}  // namespace hewer::rsimp
