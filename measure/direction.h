// SPDX-License-Identifier: MIT
/// All that is found out about the distances in one direction.
#pragma once

#include <cstdint>
#include <vector>

#include "hewer/measure.h"
#include "measure/distance_tally.h"
#include "measure/lattice.h"
#include "measure/worst_places.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Points are in steps, distances in square steps. Each worker has tallies of its own; report()
/// adds them up, with the same bits however the points were shared out.
/// Memory: 25 KiB a worker, and WorstPlaces.
class Direction {
  public:
    /// `box` of the points, in steps; `diagonal` of the original, in steps.
    Direction(ooc::Context& context, const Bounds& box, double diagonal);

    void add_vertex(unsigned worker, const Vec3& q, double squared_distance) {
        parts_[worker].vertices.add(q, squared_distance);
        places_.add(q, squared_distance);
    }
    void add_sample(unsigned worker, const Vec3& q, double squared_distance) {
        parts_[worker].samples.add(q, squared_distance);
        places_.add(q, squared_distance);
    }
    [[nodiscard]] DistanceReport report(const Lattice& lattice, std::size_t n_places) const;

    static std::uint64_t bytes(unsigned n_threads) {
        return n_threads * sizeof(Part) + WorstPlaces::kMostBytes;
    }

  private:
    struct Part {
        explicit Part(double diagonal) : vertices(diagonal), samples(diagonal) {}
        DistanceTally vertices;
        DistanceTally samples;
    };
    double diagonal_;
    ooc::Reservation parts_bytes_;
    std::vector<Part> parts_;
    WorstPlaces places_;
};

}  // namespace hewer::measuring
