// SPDX-License-Identifier: MIT
/// How many cells a grid will occupy, and which grid occupies as many as wanted, from a sample.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

/// All points in a pseudo-random choice of boxes in space. Boxes, not points, are chosen: cells are
/// then seen with all of their points or not at all, and their number scales by the share of the
/// boxes, without bias. The choice depends on positions only, not on order or threads.
class CellSample {
  public:
    /// For inputs of about `n_points` points; keeps some 80,000 to 400,000 of them.
    explicit CellSample(std::uint64_t n_points);

    [[nodiscard]] bool is_chosen(const LatticePoint& p) const;
    void add(const std::vector<LatticePoint>& points) {
        counted_.clear();
        points_.insert(points_.end(), points.begin(), points.end());
    }

    /// Estimated number of cells that all points occupy at a resolution.
    [[nodiscard]] double cells_at(double resolution) const;

    /// Resolution with an estimate of about `wanted` cells; with more cells wanted than kSeparating
    /// of what the sampling has, separating_resolution().
    [[nodiscard]] double resolution_for(double wanted) const;

    /// Coarsest power of two, from kLeastSeparating on, at which nearly every vertex has a cell of
    /// its own.
    [[nodiscard]] double separating_resolution() const;
    /// Whether `resolution` is no less than that.
    [[nodiscard]] bool is_separating(double resolution) const;

    /// Estimated number of different positions.
    [[nodiscard]] double count_positions() const;

    [[nodiscard]] std::uint64_t memory_bytes() const { return points_.capacity() * 12; }

  private:
    static constexpr double kLeastSeparating = 256;

    [[nodiscard]] double n_boxes() const { return static_cast<double>(1U << box_bits_); }
    [[nodiscard]] double count_cells(const UniformGrid& grid) const;
    [[nodiscard]] double count_nested(std::uint64_t cells_per_box) const;

    // Estimates by resolution: each is asked for several times. One thread.
    mutable std::map<double, double> counted_;
    std::uint64_t n_points_;
    std::uint64_t stride_;  // one of so many boxes is chosen
    unsigned box_bits_;     // boxes along an axis, logarithm
    std::vector<LatticePoint> points_;
};

}  // namespace hewer::cluster
