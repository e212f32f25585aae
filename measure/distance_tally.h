// SPDX-License-Identifier: MIT
/// What becomes of many distances: sums, extremes, a histogram.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hewer/types.h"
#include "ooc/exact_sum.h"

namespace hewer::measuring {

/// Counts of distances by size relative to the diagonal: kPerOctave bins for each doubling, from
/// 2^-kOctaves of the diagonal on; the first bin has all that is less, zero included.
class DistanceHistogram {
  public:
    static constexpr std::size_t kPerOctave = 32;
    static constexpr std::size_t kOctaves = 40;
    static constexpr std::size_t kBins = kOctaves * kPerOctave + 1;

    /// `squared` is the square of distance / diagonal.
    void add(double squared) { ++counts_[bin(squared)]; }
    void add(const DistanceHistogram& other) {
        for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
    }
    [[nodiscard]] std::uint64_t count(std::size_t bin) const { return counts_[bin]; }
    /// Where bin i ends, relative to the diagonal.
    static double upper_edge(std::size_t i) {
        // Of the square: kHalf bins an octave, evenly spaced within it, as its mantissa is.
        const double fraction = static_cast<double>(i % kHalf) / kHalf;
        const int octave = static_cast<int>(i / kHalf) - static_cast<int>(2 * kOctaves);
        return std::sqrt(std::ldexp(1 + fraction, octave));
    }
    /// The distance, relative to the diagonal, that `share` of all do not exceed, to within 3.1 %:
    /// interpolated in its bin.
    [[nodiscard]] double quantile(double share) const;

  private:
    // The square of a distance passes through two octaves where the distance does through one.
    static constexpr std::size_t kHalf = kPerOctave / 2;
    static constexpr unsigned kShift = 52 - std::bit_width(kHalf - 1);

    static std::size_t bin(double squared) {
        constexpr std::uint64_t kFirst =
            std::bit_cast<std::uint64_t>(1.0 / (std::uint64_t{1} << kOctaves) /
                                         (std::uint64_t{1} << kOctaves)) >>
            kShift;
        const std::uint64_t key = std::bit_cast<std::uint64_t>(squared) >> kShift;
        if (key < kFirst) return 0;
        return key - kFirst + 1 < kBins ? static_cast<std::size_t>(key - kFirst + 1) : kBins - 1;
    }

    std::array<std::uint64_t, kBins> counts_{};
};

/// Of squared distances in square steps, each at a point in steps. What it says does not depend on
/// the order in which they came, nor on how they were shared out to several tallies that were added
/// up in the end: sums are exact, and of equal distances the least point stands for all. 12 KiB.
/// One thread.
class DistanceTally {
  public:
    /// `diagonal`, in steps, is what the histogram refers to.
    explicit DistanceTally(double diagonal)
        : per_diagonal2_(diagonal > 0 ? 1 / (diagonal * diagonal) : 0) {}

    void add(const Vec3& q, double squared_distance) {
        keep_greatest(q, squared_distance);
        ++n_;
        sum_.add(std::sqrt(squared_distance));
        squares_.add(squared_distance);
        histogram_.add(squared_distance * per_diagonal2_);
    }
    void add(const DistanceTally& other) {
        if (other.n_ == 0) return;
        keep_greatest(other.worst_, other.greatest_);
        n_ += other.n_;
        sum_.add(other.sum_);
        squares_.add(other.squares_);
        histogram_.add(other.histogram_);
    }

    [[nodiscard]] std::uint64_t n() const { return n_; }
    [[nodiscard]] double mean() const {
        return n_ != 0 ? sum_.value() / static_cast<double>(n_) : 0;
    }
    [[nodiscard]] double rms() const {
        return n_ != 0 ? std::sqrt(squares_.value() / static_cast<double>(n_)) : 0;
    }
    [[nodiscard]] double maximum() const { return std::sqrt(greatest_); }
    [[nodiscard]] const Vec3& worst() const { return worst_; }
    [[nodiscard]] const DistanceHistogram& histogram() const { return histogram_; }

  private:
    void keep_greatest(const Vec3& q, double squared_distance) {
        if (n_ != 0 && squared_distance < greatest_) return;
        if (n_ == 0 || squared_distance > greatest_ || q < worst_) worst_ = q;
        greatest_ = squared_distance;
    }

    double per_diagonal2_;
    std::uint64_t n_ = 0;
    ooc::ExactSum sum_;
    ooc::ExactSum squares_;
    double greatest_ = 0;
    Vec3 worst_{};
    DistanceHistogram histogram_;
};

}  // namespace hewer::measuring
