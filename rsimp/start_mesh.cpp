// SPDX-License-Identifier: MIT
#include "rsimp/start_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/aggregate_parts.h"
#include "rsimp/block_fusion.h"
#include "rsimp/block_refiner.h"
#include "rsimp/border_corners.h"
#include "rsimp/border_samples.h"
#include "rsimp/cell_weights.h"
#include "rsimp/cluster_mesh_builder.h"
#include "rsimp/clustering.h"
#include "rsimp/drop_parts.h"
#include "rsimp/feedback.h"
#include "rsimp/grid_choice.h"

namespace hewer::rsimp {

using cluster::CellBlocks;

namespace {

// Triangles that the collapse must at least begin with, for each that is asked for.
constexpr double kEnoughTriangles = 1.25;
// Of the area for each vertex: triangles that are larger are sampled more than once by the fit.
constexpr double kLargestTriangle = 0.25;
// Cells of the next grid for each cell of one that was too coarse.
constexpr double kFinerGrid = 4;
// The first splits of an error-bound run stop at this part of the bound; the collapse uses up the
// rest.
constexpr double kErrorShareOfTree = 0.5;
// Of the mean square of the distances: a round of feedback that leaves more was the last one. Where
// it brings less than that, the next one brings next to nothing most often, and may take it back.
constexpr double kWorthAnotherRound = 0.64;
// Of the sum of squared distances: what must be far for a round of feedback that nobody has asked
// for, and the cells of which one is looked at. A scan of terrain with trees has .3, one without
// .02.
constexpr double kFarShareWorthFeedback = 0.15;
constexpr std::uint64_t kLookStride = 8;

Priority priority_of(const SimplifyOptions& options) {
    return options.priority == SplitPriority::NormalVariation ? Priority::NormalVariation
                                                              : Priority::Quadric;
}

/// A budget in triangles; 0 for error bounds and where everything goes out.
double budget(const SimplifyOptions& options, const SimplifyReport& report) {
    if (options.targets.empty()) return 0;
    return 2 * target_vertices(options.targets.front(), report.input.triangles);
}

}  // namespace

CollapseTarget collapse_target(const Target& target, const SimplifyReport& report) {
    constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
    CollapseTarget t{kAny, kAny, {{}, report.options.topology != Topology::Keep}};
    switch (target.kind) {
        case Target::Kind::Triangles:
            t.most_triangles = static_cast<std::uint64_t>(target.value);
            break;
        case Target::Kind::Vertices:
            t.most_vertices = static_cast<std::uint64_t>(target.value);
            break;
        case Target::Kind::Ratio:
            // A hair more, so that 10 % of 1000 is 100 in spite of 0.1 not being a tenth.
            t.most_triangles = static_cast<std::uint64_t>(
                target.value * static_cast<double>(report.input.triangles) * (1 + 1e-12));
            break;
        case Target::Kind::Error:
        case Target::Kind::RelativeError:
            t.most_triangles = 0;
            t.most_vertices = 0;
            t.rules = {target_error(target, report.input.bounds) / report.grid.cell_size, false};
            break;
    }
    return t;
}

namespace {

/// A start mesh and how many triangles a collapse could begin with.
struct Attempt {
    StartMesh start;
    double n_triangles = 0;
};

Attempt begin(ooc::Context& context, const CellBlocks& cells, ClusterMesh clusters) {
    Attempt attempt;
    StartMesh& start = attempt.start;
    find_unseen_cells(context, cells, clusters, start.finish.lost);
    clusters.cluster_of_cell.release();
    start.lattice = cells.lattice;
    start.grid = cells.grid;
    start.is_closed = clusters.is_closed;
    start.n_clusters = clusters.n_clusters();
    std::vector<cluster::OctreeBox> boxes;
    std::vector<std::uint64_t> first_cluster;
    for (const ClusterMesh::Block& block : clusters.blocks) {
        if (first_cluster.size() + 1 < clusters.blocks.size()) boxes.push_back(block.box);
        first_cluster.push_back(block.first_cluster);
    }
    start.finisher =
        std::make_unique<Finisher>(context, std::move(boxes), std::move(first_cluster),
                                   SurfaceKind{clusters.is_closed, clusters.has_links});
    attempt.n_triangles =
        static_cast<double>(start.finisher->begin(ClusterInput(clusters), start.finish));
    return attempt;
}

/// Refines, or with the uniform method fuses cells, until the mesh has enough triangles for the
/// collapse to choose from.
Attempt begin_with_budget(ooc::Context& context, const CellBlocks& cells,
                          const SimplifyOptions& options, StageLog& stages,
                          const SimplifyReport& report) {
    const double triangles = budget(options, report);
    const double per_vertex = clusters_per_vertex(options.method);
    double wanted = std::ceil(per_vertex * triangles / 2);
    const bool is_uniform = options.method == Method::Uniform;
    stages.begin("refine", is_uniform ? 0 : static_cast<std::uint64_t>(wanted), "clusters");
    std::unique_ptr<BlockRefiner> refiner;
    const auto find_clusters = [&] {
        const auto n = static_cast<std::uint64_t>(wanted);
        if (is_uniform) return fuse_blocks(context, cells, n);
        if (!refiner) {
            refiner = std::make_unique<BlockRefiner>(context, cells, priority_of(options));
        }
        return refiner->refine_to_count(n);
    };
    for (;;) {
        const bool is_all = options.topology == Topology::Keep || triangles == 0 ||
                            are_cells_enough(options.method, wanted, cells.n_cells());
        Attempt attempt =
            begin(context, cells, is_all ? cells_as_clusters(context, cells) : find_clusters());
        if (is_all || attempt.n_triangles >= kEnoughTriangles * triangles) return attempt;
        wanted *= std::clamp(per_vertex * triangles / std::max(attempt.n_triangles, 1.0), 1.5, 8.0);
    }
}

/// Finishes a mesh to see where it is far from the cells, and begins again with these stiffer. Or
/// stays with this mesh, if nothing is far, or too little for looks_before_feedback(), or nothing
/// has vanished and the round before has brought little. Returns the mean square of the distances;
/// that of the round before is `before`.
double improve(ooc::Context& context, CellBlocks& cells, const SimplifyOptions& options,
               double before, Attempt& attempt, StageLog& stages, SimplifyReport& report) {
    stages.begin("finish", 0, "collapses");
    StartMesh& start = attempt.start;
    MeshStore mesh =
        start.finisher->run(collapse_target(options.targets.front(), report), false, start.finish);
    if (mesh.faces.empty()) {
        attempt = {};
        attempt = begin_with_budget(context, cells, options, stages, report);
        return before;
    }
    stages.begin("feedback", 0, "cells");
    const double cell_size = cells.grid.cell_size(cells.lattice);
    FeedbackResult result =
        feed_back(context, cells, mesh, start.finisher->first_cluster(),
                  options.feedback_distance / cell_size,
                  {looks_before_feedback(options) ? kFarShareWorthFeedback : 0, kLookStride});
    if (!result.is_made) {
        start.finished = std::move(mesh);
        return before;
    }
    FeedbackReport& feedback = report.feedback;
    feedback.far_cells = result.n_far;
    feedback.last_worst = cell_size * result.worst;
    if (feedback.rounds++ == 0) feedback.first_worst = feedback.last_worst;
    const bool is_enough = result.n_far == 0 || (!result.has_vanished &&
                                                 result.mean_square > kWorthAnotherRound * before);
    if (is_enough && options.topology != Topology::Keep) {
        start.finished = std::move(mesh);
        return result.mean_square;
    }
    cells.cells = std::move(result.cells);
    cells.vanished = std::move(result.vanished);
    attempt = {};
    attempt = begin_with_budget(context, cells, options, stages, report);
    return result.mean_square;
}

/// From parts of the diagonal to cells; nothing for what the input does not have.
AttributeScales scales_for(const CellBlocks& cells, const SimplifyOptions& options,
                           const SourceInfo& info, const SimplifyReport& report) {
    const double unit =
        kAttributeUnit * report.input.bounds.diagonal() / cells.grid.cell_size(cells.lattice);
    return {info.has_colors ? unit * options.color_weight : 0,
            info.has_normals ? unit * options.normal_weight : 0};
}

SampleChoice samples_for(const CellBlocks& cells, const SimplifyOptions& options,
                         const SimplifyReport& report) {
    const double vertices = budget(options, report) / 2;
    const double cell = cells.grid.cell_size(cells.lattice);
    if (vertices == 0) return {false, std::numeric_limits<double>::infinity()};
    return {has_few_cells(options.method, cells.n_cells(), vertices),
            kLargestTriangle * report.input.area / (cell * cell) / vertices};
}

/// No cluster reaches farther than half of the error bound; if some vanish nevertheless, every cell
/// becomes a cluster, and the collapse alone decides what goes.
Attempt refine_to_error(ooc::Context& context, const CellBlocks& cells, double error,
                        StageLog& stages) {
    stages.begin("refine", 0, "clusters");
    const double key = kErrorShareOfTree * error / cells.grid.cell_size(cells.lattice);
    Attempt attempt = begin(
        context, cells, BlockRefiner(context, cells, Priority::Displacement).refine_to_key(key));
    if (attempt.start.finish.lost_cells == 0) return attempt;
    attempt = {};
    return begin(context, cells, cells_as_clusters(context, cells));
}

}  // namespace

StartMesh make_start_mesh(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
                          StageLog& stages, SimplifyReport& report) {
    const bool is_given = options.cell_size || options.method == Method::Full;
    for (double finer = 1;; finer *= kFinerGrid) {
        bool is_finest = false;
        CellBlocks cells =
            cluster_input(context, source, options, finer, stages, report, is_finest);
        if (cells.has_vertex_cells) {
            hold_border_corners(context, options.border_weight, cells);
        }
        weigh_cells(context, options.focus, cells);
        cells = drop_parts(context, std::move(cells), options, report);
        cells = aggregate_parts(context, std::move(cells), options, report);
        const AttributeScales scales = scales_for(cells, options, source.info(), report);
        if (scales.any()) {
            stages.begin("attributes", 0, "cells");
            fit_attributes(context, scales, cells);
            stages.end();
        }
        is_finest |= is_given;
        const double error = options.targets.empty()
                                 ? 0
                                 : target_error(options.targets.front(), report.input.bounds);
        if (error > 0) {
            const bool is_kept = options.topology == Topology::Keep;
            Attempt attempt = is_kept ? begin(context, cells, cells_as_clusters(context, cells))
                                      : refine_to_error(context, cells, error, stages);
            if (!is_kept && !is_finest && attempt.start.finish.lost_cells > 0) continue;
            attempt.start.samples =
                collect_samples(context, cells, samples_for(cells, options, report));
            attempt.start.scales = scales;
            return std::move(attempt.start);
        }
        const bool is_uniform = options.method == Method::Uniform;
        Attempt attempt = begin_with_budget(context, cells, options, stages, report);
        const unsigned rounds = feedback_rounds(options);
        double distance = std::numeric_limits<double>::infinity();
        for (unsigned i = 0; i < rounds && !attempt.start.finished; ++i) {
            distance = improve(context, cells, options, distance, attempt, stages, report);
        }
        const double enough = kEnoughTriangles * budget(options, report);
        if (is_finest || attempt.n_triangles >= enough) {
            if (!is_uniform || fit_rounds(options) > 0) {
                attempt.start.samples =
                    collect_samples(context, cells, samples_for(cells, options, report));
            }
            if (fit_rounds(options) > 0) {
                attempt.start.borders = collect_border_samples(context, cells);
            }
            attempt.start.scales = scales;
            return std::move(attempt.start);
        }
    }
}

}  // namespace hewer::rsimp
