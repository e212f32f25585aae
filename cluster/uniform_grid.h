// SPDX-License-Identifier: MIT
/// The uniform grid over the bounding box: which cell a lattice point is in, and where in it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "cluster/lattice.h"

namespace hewer::cluster {

/// Packed cell coordinates, 21 bits an axis: x | y << 21 | z << 42. Hashing order.
using CellKey = std::uint64_t;

/// Cells along the longest side may be any real number from 1 to kMaxResolution.
///
/// A lattice coordinate x is at x * multiplier / 2^fraction_bits cells: one 64-bit product holds
/// the cell index above the point and the place in the cell below it, without rounding.
class UniformGrid {
  public:
    static constexpr double kMaxResolution = 1 << 20;

    UniformGrid() : UniformGrid(1) {}
    explicit UniformGrid(double resolution) {
        resolution = std::clamp(resolution, 1.0, kMaxResolution);
        // The multiplier keeps 31 bits, so the product of 32 + 31 bits fits.
        extra_bits_ = 30 - std::ilogb(resolution);
        multiplier_ = static_cast<std::uint64_t>(std::llround(std::ldexp(resolution, extra_bits_)));
        fraction_bits_ = 32 + static_cast<unsigned>(extra_bits_);
        to_units_ = std::ldexp(1.0, -static_cast<int>(fraction_bits_));
        step_in_cells_ = static_cast<double>(multiplier_) * to_units_;
    }

    /// Cells along the longest side; not an integer in general.
    [[nodiscard]] double resolution() const { return step_in_cells_ * 4294967296.0; }
    /// One lattice step in units of cells.
    [[nodiscard]] double step_in_cells() const { return step_in_cells_; }
    [[nodiscard]] double cell_size(const Lattice& lattice) const {
        return lattice.step() / step_in_cells_;
    }

    /// Cell index along one axis.
    [[nodiscard]] std::uint32_t cell(std::uint32_t x) const {
        return static_cast<std::uint32_t>((x * multiplier_) >> fraction_bits_);
    }
    /// Place along one axis relative to the centre of its cell, in cells: -0.5 .. 0.5.
    [[nodiscard]] double offset(std::uint32_t x) const {
        const std::uint64_t mask = (1ULL << fraction_bits_) - 1;
        return static_cast<double>(static_cast<std::int64_t>((x * multiplier_) & mask)) *
                   to_units_ -
               0.5;
    }
    /// Place along one axis in 2^-bits cells, an integer.
    [[nodiscard]] std::int64_t quantized(std::uint32_t x, unsigned bits) const {
        return static_cast<std::int64_t>((x * multiplier_) >> (fraction_bits_ - bits));
    }
    /// A coordinate times this has the cell above bit fraction_bits(), 62 at most, and the place in
    /// it below; for who computes several at once.
    [[nodiscard]] std::uint64_t multiplier() const { return multiplier_; }
    [[nodiscard]] unsigned fraction_bits() const { return fraction_bits_; }
    [[nodiscard]] CellKey key(const LatticePoint& p) const {
        return static_cast<CellKey>(cell(p[0])) | static_cast<CellKey>(cell(p[1])) << 21 |
               static_cast<CellKey>(cell(p[2])) << 42;
    }

  private:
    std::uint64_t multiplier_ = 0;
    int extra_bits_ = 0;
    unsigned fraction_bits_ = 0;
    double to_units_ = 0;
    double step_in_cells_ = 0;
};

/// Cell coordinates of a packed key.
inline std::array<std::uint32_t, 3> unpack(CellKey key) {
    constexpr std::uint64_t kMask = (1ULL << 21) - 1;
    return {static_cast<std::uint32_t>(key & kMask), static_cast<std::uint32_t>(key >> 21 & kMask),
            static_cast<std::uint32_t>(key >> 42 & kMask)};
}

/// Spreads the low 21 bits of x so that two zero bits follow each.
inline std::uint64_t spread_bits(std::uint64_t x) {
    x &= (1ULL << 21) - 1;
    x = (x | x << 32) & 0x001f00000000ffffULL;
    x = (x | x << 16) & 0x001f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    x = (x | x << 2) & 0x1249249249249249ULL;
    return x;
}
inline std::uint32_t compact_bits(std::uint64_t x) {
    x &= 0x1249249249249249ULL;
    x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
    x = (x | x >> 4) & 0x100f00f00f00f00fULL;
    x = (x | x >> 8) & 0x001f0000ff0000ffULL;
    x = (x | x >> 16) & 0x001f00000000ffffULL;
    x = (x | x >> 32) & 0x00000000001fffffULL;
    return static_cast<std::uint32_t>(x);
}

/// Morton code of a cell: bits of z, y, x interleaved, so that a prefix is a box of an octree.
inline std::uint64_t morton(CellKey key) {
    const auto c = unpack(key);
    return spread_bits(c[0]) | spread_bits(c[1]) << 1 | spread_bits(c[2]) << 2;
}
inline std::array<std::uint32_t, 3> unpack_morton(std::uint64_t code) {
    return {compact_bits(code), compact_bits(code >> 1), compact_bits(code >> 2)};
}

}  // namespace hewer::cluster
