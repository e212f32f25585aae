// SPDX-License-Identifier: MIT
/// How far the points of a surface are from another one, by the area that they stand for.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hewer::rsimp {

/// Areas and squares by distance, in steps of a factor of the square root of two.
/// Sums depend on the order in which they are added up.
class DistanceHistogram {
  public:
    void add(float squared, float area) {
        const auto a = static_cast<double>(area);
        Bin& bin = bins_[std::bit_cast<std::uint32_t>(squared) >> kDropped];
        bin.area += a;
        bin.sum += a * static_cast<double>(squared);
    }
    void add(const DistanceHistogram& other) {
        for (std::size_t i = 0; i < bins_.size(); ++i) {
            bins_[i].area += other.bins_[i].area;
            bins_[i].sum += other.bins_[i].sum;
        }
    }
    /// Mean square over the nearest `share` of the area, in whole bins.
    [[nodiscard]] double mean_square(double share) const {
        double all = 0;
        for (const Bin& bin : bins_) all += bin.area;
        double area = 0;
        double sum = 0;
        for (const Bin& bin : bins_) {
            if (area >= share * all) break;
            area += bin.area;
            sum += bin.sum;
        }
        return area > 0 ? sum / area : 0;
    }

    /// Of the sum of all squares, what is beyond `least_square` at each place; in whole bins.
    [[nodiscard]] double share_beyond(double least_square) const {
        double sum = 0;
        double beyond = 0;
        for (const Bin& bin : bins_) {
            sum += bin.sum;
            beyond += std::max(0.0, bin.sum - least_square * bin.area);
        }
        return sum > 0 ? beyond / sum : 0;
    }

  private:
    // The exponent of a float is left, and its sign, which is always the same here.
    static constexpr unsigned kDropped = 23;
    struct Bin {
        double area = 0;
        double sum = 0;
    };
    std::array<Bin, 256> bins_{};
};

}  // namespace hewer::rsimp
