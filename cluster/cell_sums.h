// SPDX-License-Identifier: MIT
/// What a grid cell gathers while triangles stream past: exact integer sums, so that their order,
/// the number of threads and any partial summing change no bit.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "cluster/quadric.h"
#include "ooc/vector_clones.h"

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

/// Nearest integer of x for |x| < 2^51, without a library call and in vector registers.
inline constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52
inline std::int64_t round_to_int(double x) {
    return std::bit_cast<std::int64_t>(x + kRounding) - std::bit_cast<std::int64_t>(kRounding);
}

/// Four numbers that the compiler keeps in one or two registers: three coordinates and one more.
/// Scalars that are stored and then loaded as vectors stall.
using Reals = double __attribute__((vector_size(32)));
using Ints = std::int64_t __attribute__((vector_size(32)));
using Words = std::uint32_t __attribute__((vector_size(16)));

/// Rounded; see round_to_int().
HEWER_INLINE void round_to_ints(const Reals& x, Ints& result) {
    result =
        reinterpret_cast<Ints>(x + kRounding) - std::bit_cast<std::int64_t>(kRounding);  // NOLINT
}

/// Coordinates 1, 2, 0 of those 0, 1, 2.
template <typename Lanes>
HEWER_INLINE void rotate_up(const Lanes& a, Lanes& result) {
    result = __builtin_shufflevector(a, a, 1, 2, 0, 3);
}
/// The cross product; lane 3 is what the lanes 3 come to.
template <typename Lanes>
HEWER_INLINE void cross_lanes(const Lanes& a, const Lanes& b, Lanes& result) {
    Lanes up_a;
    Lanes up_b;
    rotate_up(a, up_a);
    rotate_up(b, up_b);
    const Lanes rotated = a * up_b - up_a * b;
    rotate_up(rotated, result);
}

/// A plane with a unit normal and an area, as much of it as all corners of a triangle share.
struct WeightedPlane {
    HEWER_INLINE WeightedPlane(const FixedPoint& fixed, const Reals& unit_normal, double area)
        : normal(unit_normal), weight(area * fixed.scale) {
        const Reals& n = normal;
        const Reals wn = weight * n;
        round_to_ints(Reals{wn[0], wn[0], wn[0], wn[1]} * Reals{n[0], n[1], n[2], n[1]}, a);
        yz = round_to_int(wn[1] * n[2]);
        zz = round_to_int(wn[2] * n[2]);
    }
    Reals normal;  ///< lane 3 does not matter
    Ints a;        ///< xx xy xz yy
    std::int64_t yz;
    std::int64_t zz;
    double weight;
};

/// What one or several triangles add to a cell.
class CellContribution {
  public:
    /// Adds a plane that passes through the points whose mean is `at` (relative to the cell's
    /// centre, in cells; lane 3 does not matter).
    HEWER_INLINE void add_plane(const WeightedPlane& plane, const Reals& at) {
        a_ += plane.a;
        yz_ += plane.yz;
        zz_ += plane.zz;
        const Reals along = plane.normal * at;
        const double d = along[0] + along[1] + along[2];
        Reals n_and_d = plane.normal;
        n_and_d[3] = -d;
        Ints rounded;
        round_to_ints((-plane.weight * d) * n_and_d, rounded);
        b_and_c_ += rounded;
        round_to_ints(plane.weight * at, rounded);
        moment_ += rounded;
    }
    HEWER_INLINE void add_border(const Words& chord, const Words& moment) {
        chord_ += chord;
        border_moment_ += moment;
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
        for (std::size_t i = 0; i < 4; ++i) sums.surface[i] += a_[i];
        sums.surface[4] += yz_;
        sums.surface[5] += zz_;
        for (std::size_t i = 0; i < 4; ++i) sums.surface[6 + i] += b_and_c_[i];
        for (std::size_t i = 0; i < 3; ++i) sums.surface[10 + i] += moment_[i];
        for (std::size_t i = 0; i < 3; ++i) {
            sums.border[i] += chord_[i];
            sums.border[3 + i] += border_moment_[i];
        }
        sums.is_touched = 1;
    }

    Ints a_{};
    Ints b_and_c_{};
    Ints moment_{};  // lane 3 means nothing, here and below
    Words chord_{};
    Words border_moment_{};
    std::int64_t yz_ = 0;
    std::int64_t zz_ = 0;
};

}  // namespace hewer::cluster
