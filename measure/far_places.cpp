// SPDX-License-Identifier: MIT
#include "measure/far_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hewer::measuring {

namespace {

constexpr unsigned kBits = 21;
constexpr std::uint64_t kMask = (1U << kBits) - 1;
// Of a cell in a hash table: its node and its share of the buckets.
constexpr std::uint64_t kCellBytes = 72;
constexpr std::size_t kCellsAtOnce = 1024;

}  // namespace

FarPlaces::FarPlaces(ooc::Context& context, const Bounds& box, double apart)
    : budget_(&context.budget()), origin_(box.min), apart_(apart) {
    // Any two points of a cell are within `apart`; and 21 bits are enough.
    const Vec3 size = box.size();
    const double extent = std::max({size[0], size[1], size[2]});
    const double cell = std::max(apart / std::sqrt(3.0), extent / static_cast<double>(kMask));
    per_cell_ = cell > 0 ? 1 / cell : 0;
}

void FarPlaces::add(const Vec3& q, double squared_distance) {
    if (!(squared_distance > 0)) return;
    Cell cell = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double x = std::max(0.0, (q[k] - origin_[k]) * per_cell_);
        cell = cell << kBits | std::min(static_cast<std::uint64_t>(x), kMask);
    }
    keep(cell, {squared_distance, q});
    if (cells_.size() > kMostCells) make_coarser();
}

void FarPlaces::add(const FarPlaces& other) {
    while (per_cell_ > other.per_cell_) make_coarser();
    for (const auto& [cell, place] : other.cells_) add(place.point, place.squared_distance);
}

void FarPlaces::keep(Cell cell, const Place& place) {
    if (cells_.size() == reserved_.size() * kCellsAtOnce) {
        reserved_.push_back(budget_->reserve("far places", kCellsAtOnce * kCellBytes));
    }
    const auto [at, is_new] = cells_.try_emplace(cell, place);
    Place& now = at->second;
    if (is_new || now.squared_distance > place.squared_distance) return;
    if (place.squared_distance > now.squared_distance || place.point < now.point) now = place;
}

void FarPlaces::make_coarser() {
    per_cell_ /= 2;
    const std::unordered_map<Cell, Place> finer = std::exchange(cells_, {});
    for (const auto& [cell, place] : finer) {
        Cell coarser = 0;
        for (unsigned k = 3; k-- > 0;) coarser = coarser << kBits | (cell >> kBits * k & kMask) / 2;
        keep(coarser, place);
    }
}

std::vector<WorstPlace> FarPlaces::report(const Lattice& lattice, std::size_t n) const {
    std::vector<Place> places;
    places.reserve(cells_.size());
    for (const auto& [cell, place] : cells_) places.push_back(place);
    return WorstPlaces::report(WorstPlaces::worst_of(std::move(places), n, apart_ * apart_),
                               lattice);
}

}  // namespace hewer::measuring
