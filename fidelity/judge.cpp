// SPDX-License-Identifier: MIT
#include "fidelity/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hewer/within.h"

namespace hewer::fidelity {

namespace {

constexpr std::uint64_t kFirstLook = 100'000;
// Where a proof is out of reach: so many times the points of the end, and others.
constexpr std::uint64_t kCloser = 3;
constexpr std::uint64_t kOtherSeed = 2;
// Of each surface.
constexpr unsigned kMostPlaces = 200;
// In a proof, how far from each other: one does for what is nearer.
constexpr double kBoundsApart = 2;

/// Of the options of a proof.
MeasureOptions with_places(MeasureOptions how, double bound, double diagonal) {
    how.places_apart = kBoundsApart * bound / diagonal;
    return how;
}

void add_places(const std::vector<WorstPlace>& far, double bound, DistanceReport& side) {
    // A place may be nearer by what the proof cannot tell: it is too far all the same.
    const double least = std::nextafter(bound, 2 * bound);
    for (WorstPlace place : far) {
        place.distance = std::max(least, place.distance);
        side.maximum = std::max(side.maximum, place.distance);
        side.worst.push_back(place);
    }
    std::stable_sort(
        side.worst.begin(), side.worst.end(),
        [](const WorstPlace& a, const WorstPlace& b) { return a.distance > b.distance; });
}

}  // namespace

double largest_distance(const MeasureReport& report) {
    return std::max(report.forward.maximum, report.backward.maximum);
}

Judge::Judge(MeshSource& original, const MeasureOptions& how) : original_(&original), how_(how) {
    how_.most_places = kMostPlaces;
}

MeasureReport Judge::look(MeshSource& level, const Hooks& hooks) const {
    MeasureOptions how = how_;
    how.n_samples = kFirstLook;
    return measure(*original_, level, how, hooks);
}

bool Judge::prove(MeshSource& level, double bound, MeasureReport& found, const Hooks& hooks) const {
    const WithinReport proof = prove_within(
        *original_, level, bound, with_places(how_, bound, found.bounds.diagonal()), hooks);
    switch (proof.verdict) {
        case WithinReport::Verdict::Proven:
            return true;
        case WithinReport::Verdict::Refuted:
            add_places(proof.forward, bound, found.forward);
            add_places(proof.backward, bound, found.backward);
            break;
        case WithinReport::Verdict::Undecided: {
            // Of several tries the best is the one whose samples have missed most.
            MeasureOptions how = how_;
            how.n_samples = kCloser * default_samples(std::max(original_->info().n_faces,
                                                               level.info().n_faces));
            how.seed = kOtherSeed;
            found = measure(*original_, level, how, hooks);
            break;
        }
    }
    return false;
}

bool Judge::prove_parts(const Mesh& near, MeshSource& level, const Mesh& part, double bound,
                        MeasureReport& found, const Hooks& hooks) const {
    const WithinReport proof =
        prove_parts_within(*view_mesh(near, "near places"), level, *view_mesh(part, "part"), bound,
                           with_places(how_, bound, found.bounds.diagonal()), hooks);
    add_places(proof.forward, bound, found.forward);
    add_places(proof.backward, bound, found.backward);
    return proof.verdict != WithinReport::Verdict::Refuted;
}

}  // namespace hewer::fidelity
