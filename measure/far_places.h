// SPDX-License-Identifier: MIT
/// Where a proof has failed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "measure/worst_places.h"
#include "ooc/context.h"
#include "ooc/memory_budget.h"

namespace hewer::measuring {

/// As WorstPlaces, for places that are few and may be close to each other: occupied cells alone are
/// held. When there are more than kMostCells of them, they double in size. So what is kept in the
/// end depends on what was added, not on its order, nor on which of several parts it was added to
/// before they were merged. One thread.
/// Memory: 72 bytes a cell, reserved by the thousand.
class FarPlaces {
  public:
    using Place = WorstPlaces::Place;

    /// `box` in steps; no two that are reported are within `apart` of each other, about.
    /// The context must outlive it.
    FarPlaces(ooc::Context& context, const Bounds& box, double apart);

    void add(const Vec3& q, double squared_distance);
    void add(const FarPlaces& other);
    [[nodiscard]] bool empty() const { return cells_.empty(); }
    /// The worst `n` at most, worst first, in model units.
    [[nodiscard]] std::vector<WorstPlace> report(const Lattice& lattice, std::size_t n) const;

    static constexpr std::size_t kMostCells = 1 << 14;

  private:
    using Cell = std::uint64_t;  // 21 bits an axis

    void keep(Cell cell, const Place& place);
    void make_coarser();

    ooc::MemoryBudget* budget_;
    Vec3 origin_;
    double per_cell_ = 0;
    double apart_;
    std::vector<ooc::Reservation> reserved_;
    std::unordered_map<Cell, Place> cells_;
};

}  // namespace hewer::measuring
