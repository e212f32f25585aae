// SPDX-License-Identifier: MIT
#include "rsimp/clustering.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "cluster/accumulate.h"
#include "cluster/cell_runs.h"
#include "cluster/cell_sample.h"
#include "cluster/vertex_join.h"
#include "cluster/vertex_pages.h"
#include "cluster/vertex_store.h"
#include "hewer/error.h"
#include "ooc/parallel.h"
#include "ooc/units.h"
#include "rsimp/grid_choice.h"
#include "rsimp/input_findings.h"
#include "rsimp/memory_model.h"

namespace hewer::rsimp {

using cluster::AccumulateResult;
using cluster::CellBlocks;
using cluster::CellRuns;
using cluster::CellSample;
using cluster::CellTable;
using cluster::Lattice;
using cluster::LatticePoint;
using cluster::TripleList;
using cluster::UniformGrid;
using cluster::VertexPages;
using cluster::VertexStore;

namespace {

constexpr std::uint64_t kLeastTableCells = 20'000;
// The table may be spilled so many times, and so many times as often as all cells take, before the
// triangles count as being in no order.
constexpr std::uint64_t kLeastSpills = 4;
constexpr std::uint64_t kMostSpillsPerCell = 4;
// Blocks that a few cells are cut into at least, so that several threads have work of equal size;
// but none smaller than this, or too much of each would be at its walls.
constexpr double kBlocksAtLeast = 16;
constexpr double kLeastBlockCells = 4096;
// Of the limit, for the vertices of a range of the join.
constexpr std::uint64_t kRangeShare = 4;

CellSample sample_vertices(ooc::Context& context, const VertexStore& vertices) {
    CellSample sample(vertices.vertices.size());
    std::mutex mutex;
    context.workers().for_ranges(
        vertices.vertices.size(), 1 << 16, [&](std::uint64_t begin, std::uint64_t end) {
            std::vector<LatticePoint> chosen;
            for (std::uint64_t v = begin; v < end; ++v) {
                if (vertices.is_finite(v) && sample.is_chosen(vertices.vertices[v].point)) {
                    chosen.push_back(vertices.vertices[v].point);
                }
            }
            const std::lock_guard lock(mutex);
            sample.add(chosen);
        });
    return sample;
}

/// The same from a pass over the source, which also checks the box.
CellSample sample_vertices(ooc::Context& context, MeshSource& source, const Lattice& lattice,
                           const Bounds& bounds) {
    CellSample sample(source.info().n_vertices);
    std::mutex mutex;
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        VertexBatch batch;
        std::vector<LatticePoint> chosen;
        while (source.next_vertices(batch)) {
            chosen.clear();
            for (std::uint64_t i = 0; i < batch.positions.size(); ++i) {
                const Vec3& p = batch.positions[i];
                if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (p[k] >= bounds.min[k] && p[k] <= bounds.max[k]) continue;
                    cluster::throw_outside_bounds(source,
                                                  "vertex " + std::to_string(batch.first + i));
                }
                const LatticePoint q = lattice.encode(p);
                if (sample.is_chosen(q)) chosen.push_back(q);
            }
            context.advance(batch.positions.size());
            const std::lock_guard lock(mutex);
            sample.add(chosen);
        }
    });
    return sample;
}

CellSample sample_vertices(const ooc::Spool<LatticePoint>& points) {
    CellSample sample(points.size());
    ooc::SpoolReader<LatticePoint> reader(points);
    std::vector<LatticePoint> chosen;
    while (const LatticePoint* p = reader.next()) {
        if (*p != VertexPages::kNotFinite && sample.is_chosen(*p)) chosen.push_back(*p);
    }
    sample.add(chosen);
    return sample;
}

CellSample sample_soup(ooc::Context& context, MeshSource& source, const Lattice& lattice,
                       const Bounds& bounds) {
    CellSample sample(3 * source.info().n_faces);
    std::mutex mutex;
    source.begin_triangles();
    context.workers().on_each([&](unsigned) {
        TriangleBatch batch;
        std::vector<LatticePoint> chosen;
        while (source.next_triangles(batch)) {
            chosen.clear();
            for (const auto& triangle : batch.points) {
                for (Vec3 p : triangle) {
                    for (std::size_t i = 0; i < 3; ++i) {
                        p[i] = std::clamp(p[i], bounds.min[i], bounds.max[i]);
                    }
                    const LatticePoint q = lattice.encode(p);
                    if (sample.is_chosen(q)) chosen.push_back(q);
                }
            }
            context.advance(batch.n_faces);
            const std::lock_guard lock(mutex);
            sample.add(chosen);
        }
    });
    return sample;
}

/// Most cells of a block, by the number of cells that the grid is expected to have: known before
/// the cells are, and the same however often they are spilled.
std::uint64_t most_block_cells(double expected_cells) {
    return static_cast<std::uint64_t>(std::clamp(expected_cells / kBlocksAtLeast, kLeastBlockCells,
                                                 static_cast<double>(CellBlocks::kMostCells)));
}

/// The vertices of an input, in memory or to be read again.
struct Vertices {
    bool is_resident = true;
    VertexStore store;                 // resident
    ooc::Spool<LatticePoint> spooled;  // else, if the source cannot seek
};

/// The pass over the triangles, with the cells in a table that is spilled as often as memory needs.
class Pass {
  public:
    Pass(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
         const Lattice& lattice, const Bounds& bounds, Vertices& vertices, SimplifyReport& report)
        : context_(context),
          source_(source),
          options_(options),
          lattice_(lattice),
          bounds_(bounds),
          vertices_(vertices),
          report_(report) {}

    CellBlocks run(const UniformGrid& grid, double expected_cells, AccumulateResult& result) {
        const SourceInfo& info = source_.info();
        const bool with_face_normals = options_.priority == SplitPriority::NormalVariation;
        const bool with_attributes = info.has_normals || info.has_colors;
        const cluster::CellExtras extras(with_face_normals || with_attributes,
                                         info.is_indexed && info.has_weights);
        const std::uint64_t window = window_bytes();
        const std::uint64_t most_cells = most_table_cells(extras, window);
        const auto expected = static_cast<std::uint64_t>(expected_cells * 1.05) + 1024;
        CellTable table(context_, std::min(expected, most_cells), extras);
        std::optional<VertexPages> pages;
        if (info.is_indexed) make_pages(table, window, pages);

        std::atomic<std::uint64_t> n_pieces{0};
        std::vector<TripleList> triples;
        for (unsigned t = 0; t < context_.n_threads(); ++t) triples.emplace_back(&n_pieces);
        CellRuns runs(context_, extras);
        const auto most_pieces =
            context_.n_threads() + static_cast<std::uint64_t>(CellRuns::kTriplesPerCell *
                                                              static_cast<double>(most_cells)) /
                                       TripleList::kPiece;
        table.set_overflow(
            {most_cells, [&] { runs.add(table, triples); },
             [&] { return n_pieces.load(std::memory_order_relaxed) > most_pieces; }});
        const auto add_attributes = [&] {
            if (!info.is_indexed || !(with_attributes || extras.weights)) return;
            result.defects.bad_weights = cluster::add_vertex_attributes(
                context_, source_, lattice_, grid, table, pages ? &*pages : nullptr);
            ++report_.input.vertex_passes;
        };
        // A file in order spills each cell about once.
        const std::uint64_t most_spills =
            kLeastSpills + table.epoch() + kMostSpillsPerCell * expected / most_cells;
        const cluster::AccumulateInput input{source_, lattice_,   grid, pages ? &*pages : nullptr,
                                             bounds_, most_spills};
        ++report_.input.triangle_passes;
        try {
            result = cluster::accumulate(context_, input, table, triples, with_face_normals);
        } catch (const cluster::Incoherent&) {
            // Begins again with the triangles in order of place.
            pages.reset();
            table.clear();
            for (TripleList& list : triples) list = TripleList(&n_pieces);
            n_pieces = 0;
            runs.clear();
            context_.warn(info.name +
                          ": its triangles are in no order; they are sorted by place first");
            cluster::TrianglePartition partition(context_);
            const InputDefects defects = fill(partition);
            vertices_ = {};
            result = cluster::accumulate(context_, partition, lattice_, grid, table, triples,
                                         with_face_normals);
            const std::uint64_t n_degenerate = result.defects.degenerate_triangles;
            result.defects = defects;
            result.defects.degenerate_triangles += n_degenerate;
        }
        add_attributes();
        pages.reset();
        vertices_ = {};
        if (runs.empty()) {
            return cluster::build_cell_blocks(context_, lattice_, grid, table, triples,
                                              options_.border_weight,
                                              most_block_cells(expected_cells));
        }
        runs.add(table, triples);
        table.release();
        return runs.merge(lattice_, grid, options_.border_weight, most_block_cells(expected_cells));
    }

  private:
    [[nodiscard]] std::uint64_t window_bytes() const {
        if (vertices_.is_resident || !source_.info().is_indexed) return 0;
        // Triangles at hand may use two places of the file on each thread, at least.
        const std::uint64_t least = 4 * context_.n_threads();
        const std::uint64_t wanted =
            options_.tuning.window_vertices != 0
                ? options_.tuning.window_vertices / VertexPages::kPageVertices
                : context_.budget().limit() / kWindowShare / VertexPages::kPageBytes;
        return std::max(least, wanted) * VertexPages::kPageBytes;
    }
    [[nodiscard]] std::uint64_t most_table_cells(const cluster::CellExtras& extras,
                                                 std::uint64_t window) const {
        if (options_.tuning.table_cells != 0) return options_.tuning.table_cells;
        const std::uint64_t taken = context_.budget().limit() / kSpareShare + kSpareBytes + window +
                                    (vertices_.store.vertices.size() * 16) +
                                    ooc::MemoryBudget::kFixedBytes +
                                    slack_bytes(context_.budget().limit());
        const std::uint64_t limit = context_.budget().limit();
        const double left = limit > taken ? static_cast<double>(limit - taken) : 0;
        const auto fit = static_cast<std::uint64_t>(left / CellRuns::bytes_per_cell(extras));
        // The table grows by whole chunks.
        return std::clamp<std::uint64_t>(fit - fit % CellTable::kChunk, kLeastTableCells,
                                         CellTable::kNone - 1);
    }
    InputDefects fill(cluster::TrianglePartition& partition) {
        ++report_.input.triangle_passes;
        if (!source_.info().is_indexed) {
            return cluster::partition_soup(context_, source_, lattice_, bounds_, partition).defects;
        }
        report_.input.triangle_passes += 1;
        report_.input.vertex_passes += 1;
        if (vertices_.is_resident && !source_.can_seek_vertices()) {
            vertices_.spooled = cluster::spool_vertices(context_, source_, bounds_, lattice_);
            ++report_.input.vertex_passes;
        }
        vertices_.store = {};
        const std::uint64_t range_bytes =
            options_.tuning.window_vertices != 0
                ? options_.tuning.window_vertices * sizeof(LatticePoint)
                : context_.budget().limit() / kRangeShare;
        return cluster::join_vertices(context_, source_, vertices_.spooled, lattice_, range_bytes,
                                      partition)
            .defects;
    }
    void make_pages(const CellTable& table, std::uint64_t window,
                    std::optional<VertexPages>& pages) {
        if (vertices_.is_resident) {
            pages.emplace(table, vertices_.store);
        } else {
            pages.emplace(context_, table, source_, vertices_.spooled, lattice_, bounds_,
                          window / VertexPages::kPageBytes);
        }
    }

    ooc::Context& context_;
    MeshSource& source_;
    const SimplifyOptions& options_;
    const Lattice& lattice_;
    const Bounds& bounds_;
    Vertices& vertices_;
    SimplifyReport& report_;
};

}  // namespace

CellBlocks cluster_input(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
                         double finer, StageLog& stages, SimplifyReport& report, bool& is_finest) {
    const SourceInfo& info = source.info();
    const int vertex_passes = report.input.vertex_passes;
    const int triangle_passes = report.input.triangle_passes;
    report.input = {};
    InputReport& input = report.input;
    input.vertex_passes = vertex_passes;
    input.triangle_passes = triangle_passes;
    describe_input(info, input);

    Vertices vertices;
    vertices.is_resident = options.tuning.window_vertices == 0 &&
                           16 * info.n_vertices <= context.budget().limit() / kResidentShare;
    InputDefects found;
    // Float positions can wait in the vertex store until the box is known.
    const bool is_one_pass =
        info.is_indexed && vertices.is_resident && !info.has_double_positions && !options.bounds;
    if (options.bounds) {
        input.bounds = *options.bounds;
    } else if (is_one_pass) {
        stages.begin("vertices", info.n_vertices, "vertices");
        vertices.store = cluster::load_float_vertices(context, source, found, input.bounds);
        ++input.vertex_passes;
    } else {
        stages.begin("bounds", info.is_indexed ? info.n_vertices : info.n_faces,
                     info.is_indexed ? "vertices" : "triangles");
        input.bounds = cluster::scan_bounds(context, source, found);
        ++(info.is_indexed ? input.vertex_passes : input.triangle_passes);
    }
    input.defects.nonfinite_vertices = found.nonfinite_vertices;
    input.defects.first_nonfinite = found.first_nonfinite;
    const Lattice lattice(input.bounds);

    CellSample sample(0);
    if (info.is_indexed) {
        if (!is_one_pass) {
            stages.begin("vertices", info.n_vertices, "vertices");
            ++input.vertex_passes;
        }
        if (vertices.is_resident) {
            if (!is_one_pass) {
                vertices.store = cluster::load_vertices(context, source, input.bounds, lattice);
            }
            sample = sample_vertices(context, vertices.store);
        } else if (source.can_seek_vertices()) {
            sample = sample_vertices(context, source, lattice, input.bounds);
        } else {
            vertices.spooled = cluster::spool_vertices(context, source, input.bounds, lattice);
            sample = sample_vertices(vertices.spooled);
        }
    } else {
        stages.begin("sample", info.n_faces, "triangles");
        sample = sample_soup(context, source, lattice, input.bounds);
        ++input.triangle_passes;
    }

    stages.begin("cluster", info.n_vertices + info.n_faces, "elements");
    Pass pass(context, source, options, lattice, input.bounds, vertices, report);
    AccumulateResult result;
    const UniformGrid grid(choose_resolution(options, input.bounds, sample, info.n_faces, finer));
    is_finest = !(input.bounds.diagonal() > 0) ||  // all vertices in one place
                sample.is_separating(grid.resolution() / 0.99) ||
                grid.resolution() >= 0.99 * UniformGrid::kMaxResolution;
    const double cells = sample.cells_at(grid.resolution());
    CellBlocks store = pass.run(grid, cells, result);
    store.has_vertex_cells =
        options.method == Method::Full ||
        (options.method == Method::Refine && sample.is_separating(grid.resolution()));
    stages.end();

    input.triangles = result.n_triangles;
    input.area = result.area;
    const std::uint64_t nonfinite_vertices = input.defects.nonfinite_vertices;
    const std::string first_nonfinite = input.defects.first_nonfinite;
    input.defects = result.defects;
    input.defects.nonfinite_vertices = nonfinite_vertices;
    if (!first_nonfinite.empty()) input.defects.first_nonfinite = first_nonfinite;
    judge_findings(context, source, options.strict, input);

    GridReport& g = report.grid;
    g.cell_size = store.grid.cell_size(lattice);
    const Vec3 size = input.bounds.size();
    for (std::size_t i = 0; i < 3; ++i) {
        g.dimensions[i] = static_cast<std::uint64_t>(size[i] / g.cell_size) + 1;
    }
    g.occupied_cells = store.n_cells();
    g.border_cells = store.n_border_cells;
    g.surviving_triangles = store.faces.size();
    g.is_consistently_wound = store.is_consistently_wound;
    return store;
}

}  // namespace hewer::rsimp
