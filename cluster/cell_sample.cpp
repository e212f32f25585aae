// SPDX-License-Identifier: MIT
#include "cluster/cell_sample.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "cluster/hash.h"

namespace hewer::cluster {

namespace {

// Points kept: so few, or this part of all, but no more than so many.
constexpr std::uint64_t kLeastKept = 80'000;
constexpr std::uint64_t kMostKept = 400'000;
constexpr std::uint64_t kKeptShare = 400;
// Boxes along an axis are 2^kFewBits: thousands on any surface. If only one of kManyStride or more
// is chosen, they are 2^kManyBits: of a hundred boxes the number of cells comes out a tenth wrong.
constexpr unsigned kFewBits = 7;
constexpr unsigned kManyBits = 9;
constexpr std::uint64_t kManyStride = 50;
// Width of the bracket, as a share of its lower end, at which interpolation takes over.
constexpr double kFineEnough = 0.3;
constexpr double kSeparating = 0.6;
// Of all positions, that must have cells of their own: coincident and nearly coincident vertices
// never separate.
constexpr double kNearlyAll = 0.995;
// An estimate of so many different positions among all means that all are different.
constexpr double kAllDiffer = 0.9;

}  // namespace

CellSample::CellSample(std::uint64_t n_points)
    : n_points_(n_points),
      stride_(std::max<std::uint64_t>(
          1, n_points / std::clamp(n_points / kKeptShare, kLeastKept, kMostKept))),
      box_bits_(stride_ < kManyStride ? kFewBits : kManyBits) {}

bool CellSample::is_chosen(const LatticePoint& p) const {
    if (stride_ == 1) return true;
    const unsigned shift = 32 - box_bits_;
    const std::uint64_t box = static_cast<std::uint64_t>(p[0] >> shift) |
                              static_cast<std::uint64_t>(p[1] >> shift) << box_bits_ |
                              static_cast<std::uint64_t>(p[2] >> shift) << (2 * box_bits_);
    return well_scattered(box + 1) % stride_ == 0;
}

double CellSample::count_cells(const UniformGrid& grid) const {
    const auto known = counted_.find(grid.resolution());
    if (known != counted_.end()) return known->second;
    // Cells are told apart by 32 bits of their hashes, which a core's cache has room for: of the
    // most points that are kept, some forty are missed.
    const std::uint64_t capacity = std::bit_ceil(2 * points_.size() + 2);
    std::vector<std::uint32_t> table(capacity);  // 0: empty
    std::uint64_t n = 0;
    CellKey last = ~0ULL;  // no key: keys have 63 bits
    for (const LatticePoint& p : points_) {
        const CellKey key = grid.key(p);
        if (key == last) continue;
        last = key;
        const auto hash = static_cast<std::uint32_t>(well_scattered(key) >> 32 | 1U);
        std::uint64_t i = (hash >> 1) & (capacity - 1);
        while (table[i] != 0 && table[i] != hash) i = (i + 1) & (capacity - 1);
        if (table[i] == hash) continue;
        table[i] = hash;
        ++n;
    }
    return counted_[grid.resolution()] = static_cast<double>(n) * static_cast<double>(stride_);
}

double CellSample::count_positions() const {
    const double n = count_cells(UniformGrid(UniformGrid::kMaxResolution));
    const auto all = static_cast<double>(n_points_);
    return n > kAllDiffer * all ? all : n;
}

double CellSample::separating_resolution() const {
    const double enough = kNearlyAll * count_cells(UniformGrid(UniformGrid::kMaxResolution));
    double resolution = kLeastSeparating;
    while (resolution < UniformGrid::kMaxResolution &&
           count_cells(UniformGrid(resolution)) < enough) {
        resolution *= 2;
    }
    return resolution;
}

bool CellSample::is_separating(double resolution) const {
    const double power = std::exp2(std::floor(std::log2(resolution)));
    if (power < kLeastSeparating || power >= UniformGrid::kMaxResolution) {
        return power >= kLeastSeparating;
    }
    const double n = count_cells(UniformGrid(power));
    // What a finer grid is known to have often tells already.
    if (n < kNearlyAll * counted_.rbegin()->second) return false;
    return n >= kNearlyAll * count_cells(UniformGrid(UniformGrid::kMaxResolution));
}

/// Only grids that nest in the boxes are counted without bias: a cell across the wall of a box
/// would count on both sides. Between them, and below, the count follows a power of the resolution.
double CellSample::count_nested(std::uint64_t cells_per_box) const {
    return std::max(1.0, count_cells(UniformGrid(n_boxes() * static_cast<double>(cells_per_box))));
}

double CellSample::cells_at(double resolution) const {
    const double along_box = resolution / n_boxes();
    if (along_box <= 1) return std::max(1.0, count_nested(1) * along_box * along_box);
    const auto low = static_cast<std::uint64_t>(along_box);
    const double n_low = count_nested(low);
    const double n_high = count_nested(low + 1);
    const double place = std::log(along_box / static_cast<double>(low)) /
                         std::log(static_cast<double>(low + 1) / static_cast<double>(low));
    return n_low * std::pow(n_high / n_low, place);
}

double CellSample::resolution_for(double wanted) const {
    std::uint64_t low = 1;  // cells along a box
    std::uint64_t high = 2;
    double n_low = count_nested(low);
    double n_high = count_nested(high);
    while (n_high < wanted && n_boxes() * static_cast<double>(high) < UniformGrid::kMaxResolution) {
        low = std::exchange(high, 2 * high);
        n_low = std::exchange(n_high, count_nested(high));
    }
    // There are no fewer positions than cells; to count them all takes longest.
    if (wanted >= kSeparating * n_high && wanted >= kSeparating * count_positions()) {
        return separating_resolution();
    }
    while (n_low<wanted&& static_cast<double>(high - low)> std::max(
        1.0, kFineEnough * static_cast<double>(low))) {
        const std::uint64_t middle = (low + high) / 2;
        const double n = count_nested(middle);
        (n < wanted ? low : high) = middle;
        (n < wanted ? n_low : n_high) = n;
    }
    double power = 2;  // of a surface
    if (wanted >= n_low) {
        power = std::log(n_high / n_low) /
                std::log(static_cast<double>(high) / static_cast<double>(low));
    }
    const double resolution =
        n_boxes() * static_cast<double>(low) * std::pow(wanted / n_low, 1 / std::max(0.5, power));
    return std::clamp(resolution, 1.0, UniformGrid::kMaxResolution);
}

}  // namespace hewer::cluster
