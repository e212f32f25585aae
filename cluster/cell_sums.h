// SPDX-License-Identifier: MIT
/// What a grid cell gathers while triangles stream past: exact integer sums, so that their order,
/// the number of threads and any partial summing change no bit.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

#include "cluster/lanes.h"

namespace hewer::cluster {

/// Scales of the integer sums of a run; a function of the grid alone.
///
/// Areas are in cell areas and at most resolution^2, so with s bits below the point the sum of 2^16
/// of the largest possible triangles still fits into 62 bits; s is capped at 28 (4e-9 of a cell
/// area).
struct FixedPoint {
    explicit FixedPoint(double resolution) {
        const int log2_resolution = std::ilogb(std::max(resolution, 1.0)) + 1;
        scale = std::ldexp(1.0, std::min(28, 62 - 16 - 2 * log2_resolution));
        border_bits = static_cast<unsigned>(std::min(8, (29 - log2_resolution) / 2));
    }
    double scale = 1;          ///< integer units per (cell area * cell^k)
    unsigned border_bits = 8;  ///< border sums count in 2^-border_bits cells
};

/// Integer sums over the triangle corners in one cell. Every corner brings a third of its triangle.
/// Coordinates are relative to the cell's centre, in cells.
struct CellSums {
    /// Quadric: A (xx xy xz yy yz zz), b, c; then the first moment: area * corner.
    std::array<std::int64_t, 13> surface;
    /// Signed border sums (Lindstrom & Silva 2001, without connectivity): for the corner v of (u,
    /// v, w) the vector w - u, and its moment v x (w - u). Around an inner vertex they telescope to
    /// zero; at a border vertex the chord between its two border neighbours is left. Modulo 2^32.
    std::array<std::uint32_t, 6> border;
    std::uint32_t is_touched;  ///< a triangle has a corner here (else only unused vertices)
    std::uint32_t lock;
};
static_assert(sizeof(CellSums) == 136);

/// Sums over the vertices in one cell, kept only where the input has such attributes (or the normal
/// variation metric needs face normals).
struct AttributeSums {
    std::array<std::int64_t, 3> normal;       ///< 2^-20 units; of the vertices
    std::array<std::int64_t, 3> face_normal;  ///< FixedPoint::scale; area-weighted
    std::array<std::uint64_t, 4> color;
    std::uint64_t n_colors;

    AttributeSums& operator+=(const AttributeSums& other) {
        for (std::size_t i = 0; i < 3; ++i) {
            normal[i] += other.normal[i];
            face_normal[i] += other.face_normal[i];
        }
        for (std::size_t i = 0; i < 4; ++i) color[i] += other.color[i];
        n_colors += other.n_colors;
        return *this;
    }
};

/// Sums over the vertices in one cell, kept only where the vertices have weights.
struct WeightSums {
    std::uint64_t sum;  ///< kWeightScale units
    std::uint64_t n_vertices;

    WeightSums& operator+=(const WeightSums& other) {
        sum += other.sum;
        n_vertices += other.n_vertices;
        return *this;
    }
};
/// Of a weight of at most 1000: 2^33 of them fit.
inline constexpr double kWeightScale = 1 << 20;

/// What there is in a cell beside CellSums.
struct CellExtras {
    bool attributes = false;
    bool weights = false;

    CellExtras() = default;
    // Implicit: weights are rare, and elsewhere it is a matter of attributes or none.
    CellExtras(bool with_attributes, bool with_weights = false)
        : attributes(with_attributes), weights(with_weights) {}
    [[nodiscard]] std::uint64_t bytes() const {
        return (attributes ? sizeof(AttributeSums) : 0) + (weights ? sizeof(WeightSums) : 0);
    }
    [[nodiscard]] unsigned count() const { return (attributes ? 1U : 0U) + (weights ? 1U : 0U); }
};

/// Spin lock on a field of a plain record; held for some dozen instructions.
class FieldLock {
  public:
    explicit FieldLock(std::uint32_t& field) : field_(field) {
        while (field_.exchange(1, std::memory_order_acquire) != 0) {
            while (field_.load(std::memory_order_relaxed) != 0) {
            }
        }
    }
    FieldLock(const FieldLock&) = delete;
    FieldLock& operator=(const FieldLock&) = delete;
    ~FieldLock() { field_.store(0, std::memory_order_release); }

  private:
    std::atomic_ref<std::uint32_t> field_;
};

/// What one or several triangles add to a cell.
struct CellContribution {
    Ints a;              ///< xx xy xz yy of the planes
    Ints b_and_c;        ///< b, then c
    Ints moment_and_yz;  ///< area * corner, then yz
    Words chord;         ///< lane 3 means nothing, here and below
    Words border_moment;
    std::int64_t zz;

    /// Member by member: as a whole it would be cleared by a string instruction that takes longer
    /// than adding a triangle.
    HEWER_INLINE void clear() {
        a = Ints{};
        b_and_c = Ints{};
        moment_and_yz = Ints{};
        chord = Words{};
        border_moment = Words{};
        zz = 0;
    }
    HEWER_INLINE void add(const CellContribution& other) {
        a += other.a;
        b_and_c += other.b_and_c;
        moment_and_yz += other.moment_and_yz;
        chord += other.chord;
        border_moment += other.border_moment;
        zz += other.zz;
    }
    void add_to(CellSums& sums, bool shared) const {
        if (shared) {
            const FieldLock lock(sums.lock);
            add_unlocked(sums);
        } else {
            add_unlocked(sums);
        }
    }

  private:
    void add_unlocked(CellSums& sums) const {
        for (std::size_t i = 0; i < 4; ++i) sums.surface[i] += a[i];
        sums.surface[4] += moment_and_yz[3];
        sums.surface[5] += zz;
        for (std::size_t i = 0; i < 4; ++i) sums.surface[6 + i] += b_and_c[i];
        for (std::size_t i = 0; i < 3; ++i) {
            sums.surface[10 + i] += moment_and_yz[i];
            sums.border[i] += chord[i];
            sums.border[3 + i] += border_moment[i];
        }
        sums.is_touched = 1;
    }
};

}  // namespace hewer::cluster
