// SPDX-License-Identifier: MIT
#include "cluster/cell_sample.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hewer::cluster {

namespace {

constexpr std::uint64_t kWanted = 100'000;
constexpr unsigned kBoxShift = 25;  // 128 boxes an axis: thousands on any surface
constexpr double kSeparating = 0.6;

std::uint64_t mix(std::uint64_t x) {
    x ^= x >> 33;
    x *= 0xff51afd7ed558ccdULL;
    x ^= x >> 33;
    x *= 0xc4ceb9fe1a85ec53ULL;
    x ^= x >> 33;
    return x;
}

}  // namespace

CellSample::CellSample(std::uint64_t n_points)
    : stride_(std::max<std::uint64_t>(1, n_points / kWanted)) {}

bool CellSample::is_chosen(const LatticePoint& p) const {
    if (stride_ == 1) return true;
    const std::uint64_t box = static_cast<std::uint64_t>(p[0] >> kBoxShift) |
                              static_cast<std::uint64_t>(p[1] >> kBoxShift) << 7 |
                              static_cast<std::uint64_t>(p[2] >> kBoxShift) << 14;
    return mix(box + 1) % stride_ == 0;
}

double CellSample::count_cells(const UniformGrid& grid) const {
    const std::uint64_t capacity = std::bit_ceil(2 * points_.size() + 2);
    std::vector<CellKey> table(capacity, ~0ULL);
    std::uint64_t n = 0;
    for (const LatticePoint& p : points_) {
        const CellKey key = grid.key(p);
        std::uint64_t i = mix(key) & (capacity - 1);
        while (table[i] != ~0ULL && table[i] != key) i = (i + 1) & (capacity - 1);
        if (table[i] == key) continue;
        table[i] = key;
        ++n;
    }
    return static_cast<double>(n) * static_cast<double>(stride_);
}

double CellSample::count_positions() const {
    return count_cells(UniformGrid(UniformGrid::kMaxResolution));
}

double CellSample::separating_resolution() const {
    // Coincident and nearly coincident vertices never separate; the rest must.
    const double enough = 0.995 * count_positions();
    double resolution = 256;
    while (resolution < UniformGrid::kMaxResolution && count_cells(UniformGrid(resolution)) < enough) {
        resolution *= 2;
    }
    return resolution;
}

double CellSample::resolution_for(double wanted) const {
    if (wanted >= kSeparating * count_positions()) return separating_resolution();
    // Cells on a surface grow with the square of the resolution: Newton's method on the logarithms with
    // that slope.
    double resolution = std::sqrt(std::max(1.0, wanted)) / 2;
    for (int i = 0; i < 8; ++i) {
        resolution = std::clamp(resolution, 1.0, UniformGrid::kMaxResolution);
        const double n = std::max(1.0, count_cells(UniformGrid(resolution)));
        const double ratio = wanted / n;
        if (std::fabs(ratio - 1) < 0.02) break;
        resolution *= std::sqrt(ratio);
    }
    return std::clamp(resolution, 1.0, UniformGrid::kMaxResolution);
}

}  // namespace hewer::cluster
