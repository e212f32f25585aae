// SPDX-License-Identifier: MIT
#include "hewer/plan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "cluster/cell_sample.h"
#include "cluster/lattice.h"
#include "cluster/vertex_pages.h"
#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "rsimp/grid_choice.h"
#include "rsimp/memory_model.h"

namespace hewer {

namespace {

using cluster::CellSample;
using cluster::Lattice;
using cluster::LatticePoint;

// Vertices (or triangles of a soup) that are looked at: a second's work at most.
constexpr std::uint64_t kMostSampled = 2'000'000;
// Triangles whose corners tell whether the file is in an order.
constexpr std::uint64_t kOrderSample = 1 << 16;

// Seconds per element on two cores of 2020 or later, from scripts/bench: a prediction, not a
// promise.
constexpr double kSecondsPerByte = 0.4e-9;
constexpr double kSecondsPerFace = 60e-9;
constexpr double kSecondsPerFaceOutOfOrder = 350e-9;
constexpr double kSecondsPerCell = 0.8e-6;
constexpr double kSecondsPerCluster = 4.5e-6;
constexpr double kSecondsPerFitSample = 0.5e-6;  // in a round

struct Sampled {
    Bounds bounds;
    std::vector<Vec3> points;
    std::uint64_t n_elements = 0;
};

Sampled read_sample(MeshSource& source) {
    Sampled sample;
    const auto add = [&](const Vec3& p) {
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) return;
        sample.bounds.extend(p);
        sample.points.push_back(p);
    };
    if (source.info().is_indexed) {
        source.begin_vertices();
        VertexBatch batch;
        while (sample.n_elements < kMostSampled && source.next_vertices(batch)) {
            for (const Vec3& p : batch.positions) add(p);
            sample.n_elements += batch.positions.size();
        }
    } else {
        source.begin_triangles();
        TriangleBatch batch;
        while (3 * sample.n_elements < kMostSampled && source.next_triangles(batch)) {
            for (const auto& triangle : batch.points) {
                for (const Vec3& p : triangle) add(p);
            }
            sample.n_elements += batch.n_faces;
        }
    }
    return sample;
}

/// Whether the first triangles lie together among the vertices, as VertexPages would want it. A
/// file in which triangles cannot be reached without reading all vertices is taken to be in order.
bool is_in_order(MeshSource& source) {
    if (!source.info().is_indexed || !source.can_seek_vertices()) return true;
    std::vector<std::uint64_t> pages;
    std::uint64_t n_triangles = 0;
    source.begin_triangles();
    TriangleBatch batch;
    while (n_triangles < kOrderSample && source.next_triangles(batch)) {
        for (const auto& corners : batch.corners) {
            for (const std::uint64_t v : corners) {
                pages.push_back(v / cluster::VertexPages::kPageVertices);
            }
        }
        n_triangles += batch.corners.size();
    }
    std::sort(pages.begin(), pages.end());
    const auto n_pages =
        static_cast<std::uint64_t>(std::unique(pages.begin(), pages.end()) - pages.begin());
    return !cluster::VertexPages::is_thrashing(n_pages, n_triangles);
}

// Of a copy: reading, sets and ranks, and writing, on one thread.
constexpr double kSecondsPerCopiedFace = 150e-9;

/// Method::Copy: no cells, no sample.
void plan_copy(const SourceInfo& info, const SimplifyOptions& options, PlanReport& report) {
    report.target_triangles = info.n_faces;
    report.memory_limit_bytes =
        options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit();
    report.least_memory_bytes = rsimp::least_limit(options, info);
    report.memory_bytes = report.least_memory_bytes;
    report.fits = report.least_memory_bytes <= report.memory_limit_bytes;
    // Where they do not fit: two of the sorts that make vertices of a soup; the corners for a
    // format that has no indices.
    const std::uint64_t per_face = info.is_indexed ? (info.has_double_positions ? 84 : 48)
                                                   : (info.has_double_positions ? 144 : 108);
    const std::uint64_t sorted = per_face * info.n_faces;
    const std::uint64_t free =
        report.memory_limit_bytes - std::min(report.memory_limit_bytes, report.least_memory_bytes);
    report.temp_bytes = sorted - std::min(sorted, free);
    report.bytes_read = 2 * info.n_bytes;
    const std::uint64_t n_vertices = info.is_indexed ? info.n_vertices : info.n_faces / 2;
    const std::uint64_t vertex_bytes = (info.has_double_positions ? 24U : 12U) +
                                       (info.has_normals ? 12U : 0U) + (info.has_colors ? 4U : 0U);
    report.bytes_written = info.n_faces * 13 + n_vertices * vertex_bytes;
    report.seconds = static_cast<double>(report.bytes_read) * kSecondsPerByte +
                     static_cast<double>(info.n_faces) * kSecondsPerCopiedFace;
}

}  // namespace

PlanReport plan(const InputPaths& input, const SimplifyOptions& asked) {
    rsimp::check_options(asked);
    const std::unique_ptr<MeshSource> source = open_mesh(input, opening(asked));
    const SourceInfo& info = source->info();
    SimplifyOptions options = asked;
    options.method = rsimp::method_for(asked, info);
    PlanReport report;
    report.input.path = info.name;
    report.input.format = info.format;
    report.input.bytes = info.n_bytes;
    report.input.vertices = info.n_vertices;
    report.input.faces = info.n_faces;
    report.input.triangles = info.n_faces;
    report.input.has_normals = info.has_normals;
    report.input.has_colors = info.has_colors;
    report.input.textures = info.textures;
    report.input.has_weights = info.has_weights;
    report.input.ignored = info.ignored;
    report.input.basis = InputReport::Basis::Header;
    if (options.method == Method::Copy) {
        plan_copy(info, options, report);
        return report;
    }

    const Sampled sampled = read_sample(*source);
    if (sampled.bounds.is_empty()) {
        throw FormatError(info.name + ": no vertex has finite coordinates");
    }
    report.input.bounds = options.bounds ? *options.bounds : sampled.bounds;
    const Bounds& bounds = report.input.bounds;
    const Lattice lattice(bounds);
    CellSample cells(sampled.points.size());
    std::vector<LatticePoint> chosen;
    for (Vec3 p : sampled.points) {
        for (std::size_t i = 0; i < 3; ++i) p[i] = std::clamp(p[i], bounds.min[i], bounds.max[i]);
        const LatticePoint q = lattice.encode(p);
        if (cells.is_chosen(q)) chosen.push_back(q);
    }
    cells.add(chosen);
    // The file begins with a part of the surface; the rest is taken to be like it.
    const std::uint64_t n_all = info.is_indexed ? info.n_vertices : info.n_faces;
    const double share = std::min(1.0, static_cast<double>(sampled.n_elements) /
                                           static_cast<double>(std::max<std::uint64_t>(1, n_all)));

    const bool is_free = options.targets.empty();
    const double vertices =
        is_free ? 0 : rsimp::target_vertices(options.targets.front(), info.n_faces);
    const double resolution = rsimp::choose_resolution(options, bounds, cells, info.n_faces, share);
    const cluster::UniformGrid grid(resolution);
    report.cell_size = grid.cell_size(lattice);
    report.cells = static_cast<std::uint64_t>(cells.cells_at(grid.resolution()) / share);
    report.surviving_triangles = std::min(info.n_faces, 2 * report.cells + report.cells / 8);
    const double wanted = rsimp::clusters_per_vertex(options.method) * vertices;
    const bool is_kept = options.topology == Topology::Keep;
    const bool is_all =
        is_kept || wanted == 0 || rsimp::are_cells_enough(options.method, wanted, report.cells);
    const std::uint64_t clusters = is_all ? report.cells : static_cast<std::uint64_t>(wanted);
    report.target_triangles = static_cast<std::uint64_t>(2 * vertices);
    const std::uint64_t out_triangles =
        vertices > 0 ? report.target_triangles : report.surviving_triangles;

    rsimp::MemoryCounts counts;
    counts.vertices = info.is_indexed ? info.n_vertices : 0;
    counts.cells = report.cells;
    counts.clusters = clusters;
    counts.lod_vertices = is_kept ? report.cells : out_triangles / 2;
    counts.n_threads = ooc::thread_count(options.n_threads);
    rsimp::count_attributes(options, info, counts);
    counts.has_fit = rsimp::fit_rounds(options) > 0;
    counts.joins_parts = options.aggregate.has_value();
    const unsigned n_feedback = rsimp::feedback_rounds(options);
    counts.has_feedback = n_feedback > 0;
    // One that nobody has asked for is seldom made.
    const unsigned n_timed = rsimp::looks_before_feedback(options) ? 0 : n_feedback;
    if (!is_in_order(*source)) counts.triangles_out_of_order = info.n_faces;
    report.memory_limit_bytes =
        options.memory_bytes != 0 ? options.memory_bytes : ooc::default_memory_limit();
    report.least_memory_bytes = rsimp::least_limit(options, info);
    report.memory_bytes = std::min(rsimp::ample_memory_bytes(counts, report.memory_limit_bytes),
                                   std::max(report.memory_limit_bytes, report.least_memory_bytes));
    report.fits = report.least_memory_bytes <= report.memory_limit_bytes;
    report.temp_bytes = rsimp::temp_bytes(counts, report.memory_limit_bytes);

    // Vertices once, twice with double positions (bounds first); faces once; a soup three times.
    const std::uint64_t vertex_bytes =
        info.is_indexed && info.n_vertices + info.n_faces > 0
            ? static_cast<std::uint64_t>(static_cast<double>(info.n_bytes) * 12.0 *
                                         static_cast<double>(info.n_vertices) /
                                         (12.0 * static_cast<double>(info.n_vertices) +
                                          13.0 * static_cast<double>(info.n_faces)))
            : 2 * info.n_bytes;
    const bool is_one_pass = options.bounds || (info.is_indexed && !info.has_double_positions);
    report.bytes_read = info.n_bytes + (is_one_pass ? 0 : vertex_bytes);
    const bool is_sorted = rsimp::sorts_triangles(counts, report.memory_limit_bytes);
    if (is_sorted) report.bytes_read += info.n_bytes;
    const std::uint64_t attribute_bytes =
        (info.has_normals ? 12U : 0U) + (info.has_colors ? 4U : 0U);
    report.bytes_written = out_triangles * 13 + out_triangles / 2 * (12 + attribute_bytes);
    report.seconds =
        static_cast<double>(report.bytes_read) * kSecondsPerByte +
        static_cast<double>(info.n_faces) *
            (kSecondsPerFace + (is_sorted ? kSecondsPerFaceOutOfOrder : 0)) +
        static_cast<double>(report.cells) * kSecondsPerCell +
        (is_free ? 0 : (1 + n_timed) * static_cast<double>(clusters) * kSecondsPerCluster) +
        rsimp::fit_rounds(options) * static_cast<double>(report.cells) * kSecondsPerFitSample;
    return report;
}

}  // namespace hewer
