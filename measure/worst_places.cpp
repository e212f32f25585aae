// SPDX-License-Identifier: MIT
#include "measure/worst_places.h"

#include <cmath>
#include <iterator>
#include <utility>

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
    std::vector<Place> places;
    std::copy_if(places_.begin(), places_.end(), std::back_inserter(places),
                 [](const Place& p) { return p.squared_distance > 0; });
    return worst_of(std::move(places), n, apart_sq_);
}

std::vector<WorstPlaces::Place> WorstPlaces::worst_of(std::vector<Place> places, std::size_t n,
                                                      double apart_sq) {
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
        return a.squared_distance != b.squared_distance ? a.squared_distance > b.squared_distance
                                                        : a.point < b.point;
    });
    std::vector<Place> found;
    for (const Place& p : places) {
        if (found.size() == n) break;
        const bool is_near = std::any_of(found.begin(), found.end(), [&](const Place& f) {
            double d2 = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                d2 += (f.point[k] - p.point[k]) * (f.point[k] - p.point[k]);
            }
            return d2 < apart_sq || d2 == 0;
        });
        if (!is_near) found.push_back(p);
    }
    return found;
}

std::vector<WorstPlace> WorstPlaces::report(const std::vector<Place>& places,
                                            const Lattice& lattice) {
    std::vector<WorstPlace> reported;
    reported.reserve(places.size());
    for (const Place& p : places) {
        reported.push_back(
            {lattice.to_model(p.point), std::sqrt(p.squared_distance) * lattice.step()});
    }
    return reported;
}

}  // namespace hewer::measuring
