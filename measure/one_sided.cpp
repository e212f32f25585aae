// SPDX-License-Identifier: MIT
#include "measure/one_sided.h"

#include <algorithm>
#include <cmath>

#include "ooc/array.h"
#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kRun = 4096;

/// Of some consecutive points, in steps.
struct Sums {
    std::uint64_t n;
    double sum;
    double squares;
    double greatest;  // of the squared distances; worst is the first point that has it
    Vec3 worst;

    void add(const Vec3& q, double squared_distance) {
        if (n == 0 || squared_distance > greatest) {
            greatest = squared_distance;
            worst = q;
        }
        ++n;
        sum += std::sqrt(squared_distance);
        squares += squared_distance;
    }
    void add(const Sums& next) {
        if (next.n == 0) return;
        if (n == 0 || next.greatest > greatest) {
            greatest = next.greatest;
            worst = next.worst;
        }
        n += next.n;
        sum += next.sum;
        squares += next.squares;
    }
    [[nodiscard]] double mean() const { return n != 0 ? sum / static_cast<double>(n) : 0; }
    [[nodiscard]] double rms() const {
        return n != 0 ? std::sqrt(squares / static_cast<double>(n)) : 0;
    }
    [[nodiscard]] double maximum() const { return std::sqrt(greatest); }
};

std::uint64_t n_runs(std::uint64_t n) {
    return (n + kRun - 1) / kRun;
}

/// visit_range(begin, end, visit) must call visit(point) for the points begin .. end-1.
template <typename VisitRange>
Sums sum_distances(ooc::Context& context, std::uint64_t n, const TriangleIndex& to,
                   const VisitRange& visit_range) {
    ooc::Array<Sums> runs(context.budget(), "distance sums", n_runs(n));
    context.workers().for_ranges(runs.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint64_t first = i * kRun;
            const std::uint64_t last = std::min(n, first + kRun);
            // The points of a run are neighbours: the last one's triangle is near the next one. The
            // middle of the index is a guess for the first.
            std::uint64_t guess = to.triangles().size() / 2;
            visit_range(first, last, [&](const Vec3& q) {
                const TriangleIndex::Nearest nearest = to.nearest(q, guess);
                guess = nearest.triangle;
                runs[i].add(q, nearest.squared_distance);
            });
            context.advance(last - first);
        }
    });
    Sums total{};
    for (const Sums& run : runs) total.add(run);
    return total;
}

}  // namespace

DistanceReport one_sided_distance(ooc::Context& context, std::span<const LatticePoint> points,
                                  const SurfaceSampler& sampler, const TriangleIndex& to,
                                  const Lattice& lattice) {
    const Sums vertices =
        sum_distances(context, points.size(), to,
                      [&](std::uint64_t first, std::uint64_t last, const auto& visit) {
                          for (std::uint64_t i = first; i < last; ++i) visit(to_double(points[i]));
                      });
    const Sums samples = sum_distances(
        context, sampler.n_samples(), to,
        [&](std::uint64_t first, std::uint64_t last, const auto& visit) {
            sampler.for_samples(first, last,
                                [&](const Vec3& q, std::uint64_t /*triangle*/) { visit(q); });
        });
    Sums all = vertices;
    all.add(samples);

    const double step = lattice.step();
    DistanceReport report;
    report.maximum = all.maximum() * step;
    report.mean = samples.mean() * step;
    report.rms = samples.rms() * step;
    report.vertex_maximum = vertices.maximum() * step;
    report.vertex_mean = vertices.mean() * step;
    report.vertex_rms = vertices.rms() * step;
    report.n_vertices = vertices.n;
    report.n_samples = samples.n;
    report.worst = lattice.to_model(all.worst);
    return report;
}

std::uint64_t one_sided_bytes(std::uint64_t n) {
    return (n_runs(n) + 1) * sizeof(Sums);
}

}  // namespace hewer::measuring
