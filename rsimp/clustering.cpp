// SPDX-License-Identifier: MIT
#include "rsimp/clustering.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "cluster/accumulate.h"
#include "cluster/cell_sample.h"
#include "cluster/vertex_store.h"
#include "hewer/error.h"
#include "ooc/parallel.h"
#include "ooc/units.h"
#include "rsimp/grid_choice.h"
#include "rsimp/memory_model.h"

namespace hewer::rsimp {

using cluster::AccumulateResult;
using cluster::CellBlocks;
using cluster::CellSample;
using cluster::CellTable;
using cluster::Lattice;
using cluster::LatticePoint;
using cluster::UniformGrid;
using cluster::VertexStore;

namespace {

// Room for what the sample does not show.
constexpr double kMemoryMargin = 1.1;

CellSample sample_vertices(ooc::Context& context, const VertexStore& vertices) {
    CellSample sample(vertices.points.size());
    std::mutex mutex;
    context.workers().for_ranges(
        vertices.points.size(), 1 << 16, [&](std::uint64_t begin, std::uint64_t end) {
            std::vector<LatticePoint> chosen;
            for (std::uint64_t v = begin; v < end; ++v) {
                if (vertices.is_finite(v) && sample.is_chosen(vertices.points[v])) {
                    chosen.push_back(vertices.points[v]);
                }
            }
            const std::lock_guard lock(mutex);
            sample.add(chosen);
        });
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

/// Files refuse these while they are read; other sources only count them.
void check_strict(const MeshSource& source, const SimplifyOptions& options, const InputDefects& d) {
    if (!options.strict) return;
    const auto refuse_any = [&](std::uint64_t n, const char* what) {
        if (n == 0) return;
        throw FormatError(source.info().name + ": " + std::to_string(n) + what +
                          "; leave --strict out to have them counted instead");
    };
    refuse_any(d.nonfinite_vertices, " vertices have NaN or infinite coordinates");
    refuse_any(d.nonfinite_triangles, " triangles have NaN or infinite coordinates");
    refuse_any(d.out_of_range_triangles, " triangles have a vertex index out of range");
    refuse_any(d.degenerate_triangles, " triangles have no area");
}

void warn_of(ooc::Context& context, const MeshSource& source, const InputDefects& d) {
    const std::string& name = source.info().name;
    if (d.nonfinite_vertices + d.nonfinite_triangles > 0) {
        context.warn(name + ": " + std::to_string(d.nonfinite_vertices) + " vertices and " +
                     std::to_string(d.nonfinite_triangles) +
                     " triangles with NaN or infinite coordinates were left out" +
                     (d.first_nonfinite.empty() ? "" : ", first " + d.first_nonfinite));
    }
    if (d.out_of_range_triangles > 0) {
        context.warn(name + ": " + std::to_string(d.out_of_range_triangles) +
                     " triangles with a vertex index out of range were left out, first " +
                     d.first_out_of_range);
    }
}

/// One try at clustering: the cells of the vertices, then the triangles.
class Pass {
  public:
    Pass(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
         const Lattice& lattice, const Bounds& bounds, VertexStore& vertices,
         SimplifyReport& report)
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
        CellTable table(context_, static_cast<std::uint64_t>(expected_cells * 1.05) + 1024,
                        with_face_normals || with_attributes);
        if (info.is_indexed) {
            cluster::assign_cells(context_, vertices_, grid, table);
            if (with_attributes) {
                cluster::add_vertex_attributes(context_, source_, vertices_, table);
                ++report_.input.vertex_passes;
            }
        }
        const cluster::AccumulateInput input{source_, lattice_, grid, vertices_, bounds_};
        result = cluster::accumulate(context_, input, table, with_face_normals);
        ++report_.input.triangle_passes;
        vertices_.points.release();
        vertices_.cells.release();
        return cluster::build_cell_blocks(context_, lattice_, grid, table, result.triples,
                                          options_.border_weight);
    }

  private:
    ooc::Context& context_;
    MeshSource& source_;
    const SimplifyOptions& options_;
    const Lattice& lattice_;
    const Bounds& bounds_;
    VertexStore& vertices_;
    SimplifyReport& report_;
};

/// Refuses a limit that the run would hit later, with one that will do.
void check_memory(ooc::Context& context, const SimplifyOptions& options, const SourceInfo& info,
                  double cells) {
    MemoryCounts counts;
    counts.vertices = info.n_vertices;
    counts.cells = static_cast<std::uint64_t>(kMemoryMargin * cells);
    counts.surviving_triangles = std::min(info.n_faces, 9 * counts.cells / 4);
    counts.has_attributes =
        info.has_normals || info.has_colors || options.priority == SplitPriority::NormalVariation;
    const double clusters =
        options.targets.empty()
            ? 0
            : kClustersPerVertex * target_vertices(options.targets.front(), info.n_faces);
    counts.is_refined = options.method != Method::Uniform && clusters > 0 &&
                        clusters < static_cast<double>(counts.cells);
    counts.clusters = counts.is_refined ? static_cast<std::uint64_t>(clusters) : counts.cells;
    const std::uint64_t needed = peak_memory_bytes(counts);
    if (needed > context.budget().limit()) {
        throw OutOfMemoryBudget(info.name + ": needs about " + ooc::format_bytes(needed) +
                                ", the limit is " + ooc::format_bytes(context.budget().limit()) +
                                "; raise --memory to " + ooc::format_bytes(needed) + " or more");
    }
}

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
    input.path = info.name;
    input.format = info.format;
    input.bytes = info.n_bytes;
    input.vertices = info.n_vertices;
    input.faces = info.n_faces;
    input.has_normals = info.has_normals;
    input.has_colors = info.has_colors;
    input.ignored = info.ignored;

    check_memory(context, options, info, cells_expected(options, info.n_faces, info.n_vertices));
    VertexStore vertices;
    InputDefects found;
    // Float positions can wait in the vertex store until the box is known.
    const bool is_one_pass = info.is_indexed && !info.has_double_positions && !options.bounds;
    if (options.bounds) {
        input.bounds = *options.bounds;
    } else if (is_one_pass) {
        stages.begin("vertices", info.n_vertices, "vertices");
        vertices = cluster::load_float_vertices(context, source, found, input.bounds);
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
            vertices = cluster::load_vertices(context, source, input.bounds, lattice);
            ++input.vertex_passes;
        }
        sample = sample_vertices(context, vertices);
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
                grid.resolution() >= 0.99 * sample.separating_resolution() ||
                grid.resolution() >= 0.99 * UniformGrid::kMaxResolution;
    const double cells = sample.cells_at(grid.resolution());
    check_memory(context, options, info, cells);
    CellBlocks store = pass.run(grid, cells, result);
    stages.end();

    input.triangles = result.n_triangles;
    input.area = result.area;
    const std::uint64_t nonfinite_vertices = input.defects.nonfinite_vertices;
    const std::string first_nonfinite = input.defects.first_nonfinite;
    input.defects = result.defects;
    input.defects.nonfinite_vertices = nonfinite_vertices;
    if (!first_nonfinite.empty()) input.defects.first_nonfinite = first_nonfinite;
    warn_of(context, source, input.defects);
    check_strict(source, options, input.defects);
    if (result.n_triangles == 0) {
        throw FormatError(info.name + ": has " + std::to_string(info.n_faces) +
                          " faces, but not one usable triangle");
    }

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
