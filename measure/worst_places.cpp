// SPDX-License-Identifier: MIT
#include "measure/worst_places.h"

#include <cmath>

namespace hewer::measuring {

WorstPlaces::WorstPlaces(ooc::Context& context, const Bounds& box)
    : box_(box), locks_(std::make_unique<std::array<std::mutex, kLocks>>()) {
    const double apart = kApart * box.diagonal();
    apart_sq_ = apart * apart;
    if (apart > 0) {
        // Any two points of a cell are within `apart`.
        per_cell_ = std::sqrt(3.0) / apart;
        const Vec3 size = box.size();
        for (std::size_t k = 0; k < 3; ++k) {
            size_[k] = static_cast<std::uint64_t>(size[k] * per_cell_) + 1;
        }
    }
    places_ = {context.budget(), "worst places", size_[0] * size_[1] * size_[2]};
}

void WorstPlaces::keep(Place& place, const Vec3& q, double squared_distance) {
    const std::lock_guard lock(
        (*locks_)[static_cast<std::size_t>(&place - places_.begin()) % kLocks]);
    const std::atomic_ref<double> greatest(place.squared_distance);
    const double now = greatest.load(std::memory_order_relaxed);
    if (squared_distance > now || (squared_distance == now && q < place.point)) {
        place.point = q;
        greatest.store(squared_distance, std::memory_order_relaxed);
    }
}

std::vector<WorstPlaces::Place> WorstPlaces::worst(std::size_t n) const {
    std::vector<Place> found;
    while (found.size() < n) {
        const Place* next = nullptr;
        for (const Place& p : places_) {
            if (!(p.squared_distance > 0)) continue;
            if (next != nullptr &&
                (p.squared_distance < next->squared_distance ||
                 (p.squared_distance == next->squared_distance && next->point < p.point))) {
                continue;
            }
            const bool is_near = std::any_of(found.begin(), found.end(), [&](const Place& f) {
                double d2 = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    d2 += (f.point[k] - p.point[k]) * (f.point[k] - p.point[k]);
                }
                return d2 < apart_sq_ || d2 == 0;
            });
            if (!is_near) next = &p;
        }
        if (next == nullptr) break;
        found.push_back(*next);
    }
    return found;
}

std::vector<WorstPlace> WorstPlaces::report(const Lattice& lattice, std::size_t n) const {
    std::vector<WorstPlace> places;
    for (const Place& p : worst(n)) {
        places.push_back(
            {lattice.to_model(p.point), std::sqrt(p.squared_distance) * lattice.step()});
    }
    return places;
}

}  // namespace hewer::measuring
