// SPDX-License-Identifier: MIT
/// The fixed-point frame of a run: positions as 32-bit integers on the bounding box.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "hewer/types.h"

namespace hewer::cluster {

/// A position in steps of Lattice::step() from its origin.
using LatticePoint = std::array<std::uint32_t, 3>;

/// A point and the cell that it is in: a slot of CellTable. In one piece, so that a look at both
/// meets one cache line.
struct alignas(16) PlacedPoint {
    LatticePoint point;
    std::uint32_t cell;
};
static_assert(sizeof(PlacedPoint) == 16);

/// 2^32 - 2 steps along the longest side of the box, the same step on all axes: 2.3e-10 of the
/// extent everywhere, whatever the distance to the model's own origin. Integers make equal
/// positions equal, differences exact and sums independent of their order.
class Lattice {
  public:
    Lattice() = default;
    /// `bounds` must not be empty. A box of one point gets a step of 1.
    explicit Lattice(const Bounds& bounds) : origin_(bounds.min) {
        const Vec3 size = bounds.size();
        const double longest = std::fmax(size[0], std::fmax(size[1], size[2]));
        if (longest > 0) step_ = longest / kSteps;
        inverse_step_ = 1 / step_;
    }

    /// Nearest lattice point; precondition: p inside the bounds.
    [[nodiscard]] LatticePoint encode(const Vec3& p) const {
        LatticePoint q;
        for (std::size_t i = 0; i < 3; ++i) {
            const double x = (p[i] - origin_[i]) * inverse_step_ + 0.5;
            q[i] = static_cast<std::uint32_t>(static_cast<std::int64_t>(x));
        }
        return q;
    }
    [[nodiscard]] double step() const { return step_; }
    [[nodiscard]] const Vec3& origin() const { return origin_; }

    static constexpr double kSteps = 4294967294.0;

  private:
    Vec3 origin_{};
    double step_ = 1;
    double inverse_step_ = 1;
};

}  // namespace hewer::cluster
