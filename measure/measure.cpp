// SPDX-License-Identifier: MIT
#include "hewer/measure.h"

#include <algorithm>
#include <utility>

#include "hewer/error.h"
#include "measure/area_sampler.h"
#include "measure/census.h"
#include "measure/direction.h"
#include "measure/lattice.h"
#include "measure/original_pass.h"
#include "measure/query_points.h"
#include "measure/resident_surface.h"
#include "measure/triangle_index.h"
#include "measure/waiting_points.h"
#include "ooc/context.h"
#include "ooc/external_sort.h"
#include "ooc/parallel.h"
#include "ooc/resource_usage.h"

namespace hewer {

namespace {

using namespace measuring;

constexpr std::uint64_t kLeastSamples = 500'000;
constexpr std::uint64_t kMostSamples = 10'000'000;
// More does not make a coherent file any faster.
constexpr std::uint64_t kMostWindowBytes = 128 << 20;
// Raw and decoded blocks of vertices and triangles, and their points.
constexpr std::uint64_t kBatchBytes = 2 << 20;

std::uint64_t n_samples(const MeasureOptions& options, std::uint64_t n_triangles) {
    if (options.n_samples != 0) return options.n_samples;
    return std::clamp(n_triangles, kLeastSamples, kMostSamples);
}

class Measurement {
  public:
    Measurement(MeshSource& original, MeshSource& simplified, const MeasureOptions& options,
                const Hooks& hooks)
        : original_(original),
          simplified_(simplified),
          options_(options),
          context_({.memory_bytes = options.memory_bytes,
                    .n_threads = options.n_threads,
                    .temp_dir = options.temp_dir,
                    .max_temp_bytes = options.max_temp_bytes},
                   hooks,
                   {{"scan", 2}, {"load", 1}, {"index", 1}, {"vertices", 12}, {"triangles", 8}}) {}

    MeasureReport run();

  private:
    [[nodiscard]] std::uint64_t least_window_bytes() const;
    [[nodiscard]] std::uint64_t resident_bytes(const Census& simplified) const;
    Census census_of(MeshSource& source, std::uint64_t window_bytes);
    void index_simplified(Census census, double area_of_original);
    void add_backward(Direction& backward);

    MeshSource& original_;
    MeshSource& simplified_;
    const MeasureOptions& options_;
    ooc::Context context_;
    Lattice lattice_;
    MeasureReport report_;
    // Of the simplified surface.
    ooc::Array<LatticePoint> vertices_;  // in Morton order
    std::uint64_t n_vertices_ = 0;
    TriangleIndex index_;
    WaitingPoints waiting_;
    std::uint64_t n_waiting_vertices_ = 0;  // the first; samples follow
};

/// With this much, windows of vertices and sorters work, slowly.
std::uint64_t Measurement::least_window_bytes() const {
    constexpr std::uint64_t kLeast = 1 << 20;
    return kLeast * (1 + context_.n_threads());
}

/// All that is in memory at once besides the window.
std::uint64_t Measurement::resident_bytes(const Census& simplified) const {
    const std::uint64_t n = simplified.n_triangles;
    const std::uint64_t n_query = ResidentSurface::max_points(simplified_, simplified) +
                                  AreaSampler::most(n_samples(options_, n));
    std::uint64_t bytes = ResidentSurface::bytes(simplified_, simplified) +
                          TriangleIndex::bytes(n) - n * sizeof(LatticeTriangle) +
                          WaitingPoints::bytes(n_query) + 2 * Direction::bytes(context_.n_threads()) +
                          OriginalPass::bytes(context_.n_threads()) +
                          Marks::bytes(original_.info().n_vertices) +
                          context_.n_threads() * kBatchBytes;
    // What spools and merges keep in memory.
    using Sorter = ooc::ExternalSorter<LatticePoint, int>;
    bytes += Sorter::kFanIn * (context_.page_bytes() +
                               ooc::SpoolReader<LatticePoint>::kBufferBytes);
    return bytes;
}

Census Measurement::census_of(MeshSource& source, std::uint64_t window_bytes) {
    Census census = take_census(context_, source, window_bytes);
    if (census.n_triangles == 0) {
        throw InvalidArgument(source.info().name +
                              ": has no triangle with finite corners, so no surface to measure");
    }
    return census;
}

void Measurement::index_simplified(Census census, double area_of_original) {
    context_.begin_stage("load", simplified_.info().n_faces + simplified_.info().n_vertices,
                         "elements");
    const double square_step = lattice_.step() * lattice_.step();
    const AreaSampler sampler(census.area / square_step, n_samples(options_, census.n_triangles),
                              options_.seed);
    ResidentSurface surface = load_surface(context_, simplified_, std::move(census), lattice_);
    context_.end_stage();
    context_.begin_stage("index", surface.triangles.size(), "triangles");
    index_ = TriangleIndex(context_, std::move(surface.triangles), report_.simplified_triangles);
    vertices_ = std::move(surface.points);
    n_vertices_ = surface.n_points;
    QueryPoints query = make_query_points(context_, vertices_.span().first(n_vertices_),
                                          index_.triangles(), sampler);
    n_waiting_vertices_ = query.n_vertices;
    waiting_ = WaitingPoints(context_, std::move(query.points), area_of_original);
    context_.end_stage();
}

void Measurement::add_backward(Direction& backward) {
    context_.workers().on_each([&](unsigned worker) {
        const std::uint64_t n = waiting_.size();
        const std::uint64_t n_threads = context_.n_threads();
        for (std::uint64_t i = n * worker / n_threads; i < n * (worker + 1) / n_threads; ++i) {
            if (i < n_waiting_vertices_) {
                backward.add_vertex(worker, waiting_.point(i), waiting_.squared_distance(i));
            } else {
                backward.add_sample(worker, waiting_.point(i), waiting_.squared_distance(i));
            }
        }
    });
}

MeasureReport Measurement::run() {
    const SourceInfo& from = original_.info();
    const SourceInfo& to = simplified_.info();
    context_.begin_stage("scan", from.n_faces + to.n_faces, "faces");
    Census simplified_census =
        census_of(simplified_, std::min(kMostWindowBytes, context_.budget().available() / 4));
    // Refused now, with the number that would do, rather than halfway through. The reservation ends
    // with this statement; the arrays make their own.
    const std::uint64_t resident = resident_bytes(simplified_census);
    (void)context_.budget().reserve("measuring " + from.name + " against " + to.name,
                                    resident + least_window_bytes());
    const std::uint64_t window_bytes =
        std::min(kMostWindowBytes, context_.budget().available() - resident);
    const Census census = census_of(original_, window_bytes);
    context_.end_stage();

    report_.bounds = census.bounds;
    report_.original_triangles = census.n_triangles;
    report_.simplified_triangles = simplified_census.n_triangles;
    Bounds both = census.bounds;
    both.extend(simplified_census.bounds);
    lattice_ = Lattice(both);
    const double square_step = lattice_.step() * lattice_.step();
    const double diagonal = census.bounds.diagonal() / lattice_.step();
    Bounds box;
    box.extend(to_double(lattice_.from_model(both.min)));
    box.extend(to_double(lattice_.from_model(both.max)));
    Direction forward(context_, box, diagonal);
    Direction backward(context_, box, diagonal);
    index_simplified(std::move(simplified_census), census.area / square_step);

    const AreaSampler sampler(census.area / square_step, n_samples(options_, census.n_triangles),
                              options_.seed);
    ooc::Array<float> greatest;
    OriginalPass pass(context_, {original_, census, lattice_, index_, sampler, window_bytes},
                      forward, waiting_, greatest);
    context_.begin_stage("vertices", from.is_indexed ? from.n_vertices : from.n_faces, "elements");
    pass.measure_vertices();
    context_.end_stage();
    context_.begin_stage("triangles", from.n_faces, "faces");
    pass.measure_triangles();
    add_backward(backward);
    context_.end_stage();

    report_.forward = forward.report(lattice_);
    report_.backward = backward.report(lattice_);
    report_.seconds = context_.elapsed_seconds();
    report_.temp_bytes_written = context_.spill().bytes_written();
    report_.peak_resident_bytes = ooc::peak_resident_bytes();
    return std::move(report_);
}

}  // namespace

MeasureReport measure(MeshSource& original, MeshSource& simplified, const MeasureOptions& options,
                      const Hooks& hooks) {
    return Measurement(original, simplified, options, hooks).run();
}

}  // namespace hewer
