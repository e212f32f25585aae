// SPDX-License-Identifier: MIT
#include "hewer/measure.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "hewer/error.h"
#include "hewer/mesh_sink.h"
#include "measure/area_sampler.h"
#include "measure/census.h"
#include "measure/direction.h"
#include "measure/distance_map.h"
#include "measure/lattice.h"
#include "measure/limits.h"
#include "measure/original_pass.h"
#include "measure/points.h"
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
// Raw and decoded blocks of vertices and triangles, and their points.
constexpr std::uint64_t kBatchBytes = 2 << 20;

std::uint64_t n_samples(const MeasureOptions& options, std::uint64_t n_triangles) {
    return options.n_samples != 0 ? options.n_samples : default_samples(n_triangles);
}

class Measurement {
  public:
    Measurement(MeshSource& original, MeshSource& simplified, const MeasureOptions& options,
                const Hooks& hooks)
        : original_(original),
          simplified_(simplified),
          options_(options),
          context_(limits_of(options), hooks,
                   {{"scan", 2},
                    {"load", 1},
                    {"index", 1},
                    {"vertices", 12},
                    {"triangles", 8},
                    {"map", options.map.empty() ? 0.0 : 3.0}}) {
        // Refused before the work, not after.
        if (!options.map.empty())
            map_ = create_mesh_file(options.map, {.overwrite = options.overwrite});
    }

    MeasureReport run();

  private:
    [[nodiscard]] std::uint64_t least_window_bytes() const;
    [[nodiscard]] std::uint64_t resident_bytes(const Census& simplified) const;
    void index_simplified(const Census& census, double area_of_original);
    void add_backward(Direction& backward);
    void write_map(const Census& original, const Census& simplified);
    [[nodiscard]] ooc::Array<float> distances_of_vertices();
    [[nodiscard]] std::uint64_t find_vertex(const LatticePoint& p) const;
    [[nodiscard]] bool maps_simplified() const {
        return map_ != nullptr && options_.map_of == MapOf::Simplified;
    }

    MeshSource& original_;
    MeshSource& simplified_;
    const MeasureOptions& options_;
    ooc::Context context_;
    ooc::HeldInput held_original_{context_.hold(original_)};
    ooc::HeldInput held_simplified_{context_.hold(simplified_)};
    std::unique_ptr<MeshSink> map_;
    Lattice lattice_;
    MeasureReport report_;
    // Of the simplified surface.
    ooc::Array<LatticePoint> vertices_;  // in Morton order
    std::uint64_t n_vertices_ = 0;
    TriangleIndex index_;
    WaitingPoints waiting_;
    std::uint64_t n_waiting_vertices_ = 0;  // the first; samples follow
    // For a map: the greatest squared distance of the points whose nearest triangle it is.
    ooc::Array<float> greatest_;
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
    std::uint64_t bytes =
        ResidentSurface::bytes(simplified_, simplified) + TriangleIndex::bytes(n) -
        n * sizeof(LatticeTriangle) + WaitingPoints::bytes(n_query) +
        2 * Direction::bytes(context_.n_threads()) + OriginalPass::bytes(context_.n_threads()) +
        Marks::bytes(original_.info().n_vertices) + context_.n_threads() * kBatchBytes;
    // What spools and merges keep in memory.
    using Sorter = ooc::ExternalSorter<LatticePoint, int>;
    bytes += Sorter::kLeastFanIn *
             (context_.page_bytes() + ooc::SpoolReader<LatticePoint>::kBufferBytes);
    if (maps_simplified()) {
        bytes += sizeof(float) * (n + ResidentSurface::max_points(simplified_, simplified));
    }
    return bytes;
}

void Measurement::index_simplified(const Census& census, double area_of_original) {
    context_.begin_stage("load", simplified_.info().n_faces + simplified_.info().n_vertices,
                         "elements");
    const double square_step = lattice_.step() * lattice_.step();
    const AreaSampler sampler(census.area / square_step, n_samples(options_, census.n_triangles),
                              options_.seed);
    ResidentSurface surface = load_surface(context_, simplified_, census, lattice_);
    context_.end_stage();
    context_.begin_stage("index", surface.triangles.size(), "triangles");
    index_ = TriangleIndex(context_, std::move(surface.triangles), report_.simplified_triangles);
    vertices_ = std::move(surface.points);
    n_vertices_ = surface.n_points;
    QueryPoints query = make_query_points(context_, vertices_.span().first(n_vertices_),
                                          index_.triangles(), sampler);
    n_waiting_vertices_ = query.n_vertices;
    if (maps_simplified()) {
        greatest_ = {context_.budget(), "distances by triangle", index_.triangles().size()};
    }
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

/// The first of those at `p`.
std::uint64_t Measurement::find_vertex(const LatticePoint& p) const {
    const LatticePoint* const begin = vertices_.begin();
    return static_cast<std::uint64_t>(
        std::lower_bound(begin, begin + n_vertices_, p, MortonLess()) - begin);
}

/// In steps: its own, or what is farther and belongs to one of its triangles.
ooc::Array<float> Measurement::distances_of_vertices() {
    ooc::Array<float> distances(context_.budget(), "distances of vertices", n_vertices_);
    for (std::uint64_t i = 0; i < n_vertices_; ++i) {
        distances[i] = static_cast<float>(std::sqrt(waiting_.squared_distance(i)));
    }
    for (std::uint64_t t = 0; t < greatest_.size(); ++t) {
        const float distance = std::sqrt(greatest_[t]);
        for (const LatticePoint& p : index_.triangles()[t]) {
            float& at = distances[find_vertex(p)];
            at = std::max(at, distance);
        }
    }
    return distances;
}

void Measurement::write_map(const Census& original, const Census& simplified) {
    const double farthest = std::max(report_.forward.quantiles.back().distance,
                                     report_.backward.quantiles.back().distance);
    report_.map_range = options_.map_range > 0 ? options_.map_range : farthest;
    // All at distance 0: any range gives the first colour.
    if (!(report_.map_range > 0)) report_.map_range = lattice_.step();
    const double range = report_.map_range / lattice_.step();
    MeshSource& source = maps_simplified() ? simplified_ : original_;
    context_.begin_stage("map", source.info().n_vertices + source.info().n_faces, "elements");
    if (maps_simplified()) {
        const ooc::Array<float> distances = distances_of_vertices();
        write_distance_map(
            context_, source, simplified, lattice_,
            [&](std::span<const LatticePoint> points, std::span<double> out) {
                std::transform(points.begin(), points.end(), out.begin(),
                               [&](const LatticePoint& p) { return distances[find_vertex(p)]; });
            },
            range, *map_);
    } else {
        write_distance_map(
            context_, source, original, lattice_,
            [&](std::span<const LatticePoint> points, std::span<double> out) {
                TriangleIndex::Walk walk(index_);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    out[i] = std::sqrt(walk.nearest(to_double(points[i])).squared_distance);
                }
            },
            range, *map_);
    }
    context_.end_stage();
}

MeasureReport Measurement::run() {
    const SourceInfo& from = original_.info();
    const SourceInfo& to = simplified_.info();
    context_.begin_stage("scan", from.n_faces + to.n_faces, "faces");
    Census simplified_census = take_census_of_surface(
        context_, simplified_, std::min(kMostWindowBytes, context_.budget().available() / 4));
    // Refused now, with the number that would do, rather than halfway through. The reservation ends
    // with this statement; the arrays make their own.
    const std::uint64_t resident = resident_bytes(simplified_census);
    (void)context_.budget().reserve("measuring " + from.name + " against " + to.name,
                                    resident + least_window_bytes());
    const std::uint64_t window_bytes =
        std::min(kMostWindowBytes, context_.budget().available() - resident);
    const Census census = take_census_of_surface(context_, original_, window_bytes);
    context_.end_stage();

    report_.bounds = census.bounds;
    report_.original_triangles = census.n_triangles;
    report_.simplified_triangles = simplified_census.n_triangles;
    Bounds both = census.bounds;
    both.extend(simplified_census.bounds);
    lattice_ = Lattice(both);
    const double square_step = lattice_.step() * lattice_.step();
    const double diagonal = census.bounds.diagonal() / lattice_.step();
    const Bounds box = lattice_.box_from_model(both);
    Direction forward(context_, box, diagonal);
    Direction backward(context_, box, diagonal);
    index_simplified(simplified_census, census.area / square_step);

    const AreaSampler sampler(census.area / square_step, n_samples(options_, census.n_triangles),
                              options_.seed);
    OriginalPass pass(context_, {original_, census, lattice_, index_, sampler, window_bytes},
                      forward, waiting_, greatest_);
    context_.begin_stage("vertices", from.is_indexed ? from.n_vertices : from.n_faces, "elements");
    pass.measure_vertices();
    context_.end_stage();
    context_.begin_stage("triangles", from.n_faces, "faces");
    pass.measure_triangles();
    add_backward(backward);
    context_.end_stage();

    report_.forward = forward.report(lattice_, options_.most_places);
    report_.backward = backward.report(lattice_, options_.most_places);
    if (map_ != nullptr) write_map(census, simplified_census);
    report_.seconds = context_.elapsed_seconds();
    report_.temp_bytes_written = context_.spill().bytes_written();
    report_.peak_resident_bytes = ooc::peak_resident_bytes();
    return std::move(report_);
}

}  // namespace

std::uint64_t default_samples(std::uint64_t n_triangles) {
    return std::clamp(n_triangles, kLeastSamples, kMostSamples);
}

MeasureReport measure(MeshSource& original, MeshSource& simplified, const MeasureOptions& options,
                      const Hooks& hooks) {
    return Measurement(original, simplified, options, hooks).run();
}

}  // namespace hewer
