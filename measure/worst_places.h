// SPDX-License-Identifier: MIT
/// Where a surface is farthest from another, in several places.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "hewer/measure.h"
#include "hewer/types.h"
#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Space is cut into cells of kApart / sqrt(3) of the diagonal, each of which keeps the farthest of
/// its points; in the end the worst of them are taken one by one, each at least kApart of the
/// diagonal away from those before. Of equal distances the least point is kept: the order in which
/// points come does not show. Distance 0 is no place.
/// Memory: 32 bytes a cell of the box, at most 1.5 MB, reserved. add() is thread-safe.
class WorstPlaces {
  public:
    static constexpr double kApart = 0.05;  // of the diagonal

    struct Place {
        double squared_distance = 0;
        Vec3 point{};
    };

    /// `box` in steps.
    WorstPlaces(ooc::Context& context, const Bounds& box);

    void add(const Vec3& q, double squared_distance) {
        Place& place = places_[cell_of(q)];
        const std::atomic_ref<double> greatest(place.squared_distance);
        if (squared_distance < greatest.load(std::memory_order_relaxed) ||
            !(squared_distance > 0)) {
            return;
        }
        keep(place, q, squared_distance);
    }
    /// The worst `n` at most, worst first.
    [[nodiscard]] std::vector<Place> worst(std::size_t n) const;
    /// The same for a report: in model units.
    [[nodiscard]] std::vector<WorstPlace> report(const Lattice& lattice, std::size_t n) const {
        return report(worst(n), lattice);
    }

    /// The worst `n` at most of any places, worst first, each at least the root of `apart_sq` away
    /// from those before.
    static std::vector<Place> worst_of(std::vector<Place> places, std::size_t n, double apart_sq);
    static std::vector<WorstPlace> report(const std::vector<Place>& places, const Lattice& lattice);

    static constexpr std::uint64_t kMostBytes = 36ULL * 36 * 36 * sizeof(Place);

  private:
    static constexpr std::size_t kLocks = 64;

    [[nodiscard]] std::uint64_t cell_of(const Vec3& q) const {
        std::uint64_t cell = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double x = std::max(0.0, (q[k] - box_.min[k]) * per_cell_);
            cell = cell * size_[k] + std::min(static_cast<std::uint64_t>(x), size_[k] - 1);
        }
        return cell;
    }
    void keep(Place& place, const Vec3& q, double squared_distance);

    Bounds box_;
    double per_cell_ = 0;
    double apart_sq_ = 0;
    std::array<std::uint64_t, 3> size_{1, 1, 1};
    ooc::Array<Place> places_;
    std::unique_ptr<std::array<std::mutex, kLocks>> locks_;
};

}  // namespace hewer::measuring
