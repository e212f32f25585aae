// SPDX-License-Identifier: MIT
#include "hewer/measure.h"

#include <algorithm>
#include <utility>

#include "hewer/error.h"
#include "measure/lattice.h"
#include "measure/one_sided.h"
#include "measure/resident_surface.h"
#include "measure/surface_sampler.h"
#include "measure/triangle_index.h"
#include "ooc/context.h"
#include "ooc/resource_usage.h"

namespace hewer {

namespace {

using namespace measuring;

constexpr std::uint64_t kLeastSamples = 500'000;
constexpr std::uint64_t kMostSamples = 10'000'000;

std::uint64_t n_samples(const MeasureOptions& options, std::uint64_t n_triangles) {
    if (options.n_samples != 0) return options.n_samples;
    return std::clamp(n_triangles, kLeastSamples, kMostSamples);
}

[[noreturn]] void throw_no_triangles(const MeshSource& source) {
    throw InvalidArgument(source.info().name +
                          ": has no triangle with finite corners, so no surface to measure");
}

Census census_of(ooc::Context& context, MeshSource& source) {
    Census census = take_census(context, source);
    if (census.n_triangles == 0 || census.bounds.is_empty()) throw_no_triangles(source);
    return census;
}

/// All that measuring needs beyond the marks of a census, for one of the two surfaces.
std::uint64_t bytes_needed(const MeshSource& source, const Census& census,
                           const MeasureOptions& options) {
    const std::uint64_t n = census.n_triangles;
    const std::uint64_t n_points = source.info().is_indexed ? source.info().n_vertices : 3 * n;
    return ResidentSurface::bytes(source, census) + TriangleIndex::bytes(n) -
           n * sizeof(LatticeTriangle) + SurfaceSampler::bytes(n) +
           one_sided_bytes(std::max(n_points, n_samples(options, n)));
}

struct Side {
    ooc::Array<LatticePoint> points;
    std::uint64_t n_points = 0;
    TriangleIndex index;
};

ResidentSurface load(ooc::Context& context, MeshSource& source, Census census,
                     const Lattice& lattice) {
    ResidentSurface surface = load_surface(context, source, std::move(census), lattice);
    if (surface.n_triangles == 0) throw_no_triangles(source);
    return surface;
}

Side index(ooc::Context& context, ResidentSurface surface) {
    Side side;
    side.points = std::move(surface.points);
    side.n_points = surface.n_points;
    side.index = TriangleIndex(context, std::move(surface.triangles), surface.n_triangles);
    return side;
}

DistanceReport distance(ooc::Context& context, const char* stage, const Side& from, const Side& to,
                        const Lattice& lattice, const MeasureOptions& options) {
    const auto triangles = from.index.triangles();
    const SurfaceSampler sampler(context, triangles, n_samples(options, triangles.size()),
                                 options.seed);
    context.begin_stage(stage, from.n_points + sampler.n_samples(), "points");
    const DistanceReport report = one_sided_distance(
        context, from.points.span().first(from.n_points), sampler, to.index, lattice);
    context.end_stage();
    return report;
}

}  // namespace

// Passes over each source: triangles and vertices for the box of what is used, then vertices and
// triangles to load them (a soup: two over the triangles).
// Memory: for each surface 43 bytes a triangle and 12 bytes a vertex (TriangleIndex,
// ResidentSurface), both resident; a soup has 36 bytes a triangle for its corners instead.
MeasureReport measure(MeshSource& original, MeshSource& simplified, const MeasureOptions& options,
                      const Hooks& hooks) {
    ooc::Context context({.memory_bytes = options.memory_bytes, .n_threads = options.n_threads},
                         hooks,
                         {{"scan", 1}, {"load", 2}, {"index", 4}, {"forward", 8}, {"backward", 2}});
    const std::uint64_t n_elements = original.info().n_faces + original.info().n_vertices +
                                     simplified.info().n_faces + simplified.info().n_vertices;

    context.begin_stage("scan", n_elements, "elements");
    Census original_census = census_of(context, original);
    Census simplified_census = census_of(context, simplified);
    context.end_stage();

    MeasureReport report;
    report.bounds = original_census.bounds;
    Bounds both = original_census.bounds;
    both.extend(simplified_census.bounds);
    const Lattice lattice(both);
    // Refused now, with the number that would do, rather than halfway through. The reservation ends
    // with this statement; the arrays make their own.
    (void)context.budget().reserve(
        "measuring " + original.info().name + " against " + simplified.info().name,
        bytes_needed(original, original_census, options) +
            bytes_needed(simplified, simplified_census, options));

    context.begin_stage("load", n_elements, "elements");
    ResidentSurface original_surface = load(context, original, std::move(original_census), lattice);
    ResidentSurface simplified_surface =
        load(context, simplified, std::move(simplified_census), lattice);
    context.end_stage();
    report.original_triangles = original_surface.n_triangles;
    report.simplified_triangles = simplified_surface.n_triangles;

    context.begin_stage("index", report.original_triangles + report.simplified_triangles,
                        "triangles");
    const Side from = index(context, std::move(original_surface));
    const Side to = index(context, std::move(simplified_surface));
    context.end_stage();

    report.forward = distance(context, "forward", from, to, lattice, options);
    report.backward = distance(context, "backward", to, from, lattice, options);
    report.seconds = context.elapsed_seconds();
    report.peak_resident_bytes = ooc::peak_resident_bytes();
    return report;
}

}  // namespace hewer
