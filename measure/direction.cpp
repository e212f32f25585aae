// SPDX-License-Identifier: MIT
#include "measure/direction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hewer::measuring {

namespace {

constexpr std::array kShares{0.5, 0.9, 0.99, 0.999};

std::vector<DistanceBin> octaves_of(const DistanceHistogram& histogram, double diagonal) {
    std::vector<DistanceBin> bins;
    const auto count = [&](std::size_t octave) {
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < DistanceHistogram::kPerOctave; ++i) {
            sum += histogram.count(1 + octave * DistanceHistogram::kPerOctave + i);
        }
        return sum;
    };
    const auto edge = [&](std::size_t octave) {
        return diagonal * DistanceHistogram::upper_edge(octave * DistanceHistogram::kPerOctave);
    };
    bins.push_back({0, edge(0), histogram.count(0)});
    for (std::size_t o = 0; o < DistanceHistogram::kOctaves; ++o) {
        bins.push_back({edge(o), edge(o + 1), count(o)});
    }
    while (!bins.empty() && bins.back().n == 0) bins.pop_back();
    std::size_t first = 0;
    while (first < bins.size() && bins[first].n == 0) ++first;
    bins.erase(bins.begin(), bins.begin() + static_cast<std::ptrdiff_t>(first));
    return bins;
}

}  // namespace

Direction::Direction(ooc::Context& context, const Bounds& box, double diagonal)
    : diagonal_(diagonal),
      parts_bytes_(
          context.budget().reserve("distance tallies", context.n_threads() * sizeof(Part))),
      parts_(context.n_threads(), Part(diagonal)),
      places_(context, box) {}

DistanceReport Direction::report(const Lattice& lattice, std::size_t n_places) const {
    DistanceTally vertices(diagonal_);
    DistanceTally samples(diagonal_);
    for (const Part& part : parts_) {
        vertices.add(part.vertices);
        samples.add(part.samples);
    }
    const double step = lattice.step();
    DistanceReport report;
    report.maximum = std::max(vertices.maximum(), samples.maximum()) * step;
    report.mean = samples.mean() * step;
    report.rms = samples.rms() * step;
    report.vertex_maximum = vertices.maximum() * step;
    report.vertex_mean = vertices.mean() * step;
    report.vertex_rms = vertices.rms() * step;
    report.n_vertices = vertices.n();
    report.n_samples = samples.n();
    for (const double share : kShares) {
        report.quantiles.push_back({share, samples.histogram().quantile(share) * diagonal_ * step});
    }
    report.histogram = octaves_of(samples.histogram(), diagonal_ * step);
    report.worst = places_.report(lattice, n_places);
    return report;
}

}  // namespace hewer::measuring
