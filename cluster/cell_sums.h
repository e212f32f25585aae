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
};

/// Sums over the vertices in one cell, kept only where the vertices have weights.
struct WeightSums {
    std::uint64_t sum;  ///< kWeightScale units
    std::uint64_t n_vertices;
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

/// What one or several triangles add to a cell. The sums of the surface are computed four at a
/// time, in the order of CellSums; scalars that are stored and then loaded as vectors stall.
// A worker has a handful of them: padding costs nothing.
class CellContribution {  // NOLINT(clang-analyzer-optin.performance.Padding)
  public:
    std::array<std::uint32_t, 6> border{};

    /// Adds a plane with unit normal n and area `weight` that passes through the points whose mean
    /// is `at` (relative to the cell's centre, in cells).
    HEWER_INLINE void add_plane(const FixedPoint& fixed, const Vec3& n, double weight,
                                const Vec3& at) {
        const double w = weight * fixed.scale;
        const Vec3 wn{w * n[0], w * n[1], w * n[2]};
        const double d = dot(n, at);
        const double wd = -w * d;
        add(0, Reals{wn[0], wn[0], wn[0], wn[1]}, Reals{n[0], n[1], n[2], n[1]});
        add(1, Reals{wn[1], wn[2], wd, wd}, Reals{n[2], n[2], n[0], n[1]});
        add(2, Reals{wd, wd, w, w}, Reals{n[2], -d, at[0], at[1]});
        last_ += round_to_int(w * at[2]);
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
    using Reals = double __attribute__((vector_size(32)));
    using Ints = std::int64_t __attribute__((vector_size(32)));
    static constexpr std::size_t kLanes = 4;

    /// Rounded products; see round_to_int().
    HEWER_INLINE void add(std::size_t i, const Reals& a, const Reals& b) {
        const Reals shifted = a * b + kRounding;
        lanes_[i] += reinterpret_cast<Ints>(shifted) - std::bit_cast<std::int64_t>(kRounding);
    }
    void add_unlocked(CellSums& sums) const {
        for (std::size_t v = 0; v < lanes_.size(); ++v) {
            for (std::size_t i = 0; i < kLanes; ++i) sums.surface[kLanes * v + i] += lanes_[v][i];
        }
        sums.surface.back() += last_;
        for (std::size_t i = 0; i < border.size(); ++i) sums.border[i] += border[i];
        sums.is_touched = 1;
    }

    std::array<Ints, 3> lanes_{};
    std::int64_t last_ = 0;
};

}  // namespace hewer::cluster
