// SPDX-License-Identifier: MIT
/// The pipeline: input -> cell store -> clusters -> manifold mesh -> finishing collapse -> LODs.
#include "hewer/simplify.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "hewer/version.h"
#include "ooc/context.h"
#include "ooc/parallel.h"
#include "ooc/resource_usage.h"
#include "ooc/vec3.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/grid_choice.h"
#include "rsimp/lod.h"
#include "rsimp/manifold.h"
#include "rsimp/stage_log.h"
#include "rsimp/start_mesh.h"
#include "rsimp/topology_change.h"

namespace hewer {

namespace {

using namespace rsimp;

// Expected shares of the time, for progress.
std::vector<ooc::StageWeight> stage_weights() {
    return {{"bounds", 1}, {"vertices", 2}, {"sample", 2},  {"cluster", 8},
            {"refine", 8}, {"mesh", 2},     {"finish", 12}, {"write", 2}};
}

CollapseTarget collapse_target(const Target& target, const SimplifyReport& report,
                               const cluster::CellStore& store) {
    constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
    CollapseTarget t{kAny, kAny, {}};
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
            t.most_displacement =
                target_error(target, report.input.bounds) / store.grid.cell_size(store.lattice);
            break;
    }
    return t;
}

/// Makes the classes of `merged` the clusters of the run: cells and vertices refer to them from now
/// on.
void adopt(ooc::Context& context, const MergedMesh& merged, Clusters& clusters,
           ManifoldMesh& manifold) {
    // Cells of which nothing is left get a class without a vertex.
    const auto none = static_cast<std::uint32_t>(merged.n_classes);
    ooc::Array<std::uint32_t> class_of_cluster(context.budget(), "merged clusters",
                                               clusters.n_clusters);
    std::fill(class_of_cluster.begin(), class_of_cluster.end(), none);
    for (std::uint32_t v = 0; v < manifold.cluster_of_vertex.size(); ++v) {
        const std::uint32_t c = merged.class_of_old_vertex[v];
        if (c != kNoIndex) class_of_cluster[manifold.cluster_of_vertex[v]] = c;
    }
    for (std::uint32_t& c : clusters.cluster_of_cell) c = class_of_cluster[c];
    clusters.n_clusters = merged.n_classes + 1;
    manifold.cluster_of_vertex = {context.budget(), "vertices", merged.class_of_vertex.size()};
    std::copy(merged.class_of_vertex.begin(), merged.class_of_vertex.end(),
              manifold.cluster_of_vertex.begin());
}

std::string hex(std::uint64_t value) {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
    return text.data();
}

}  // namespace

SimplifyReport simplify(MeshSource& source, const SinkFactory& sinks,
                        const SimplifyOptions& options, const Hooks& hooks,
                        const ParentsCallback& parents) {
    const auto start = std::chrono::steady_clock::now();
    check_options(options);
    ooc::Context context(options.memory_bytes, options.n_threads, hooks, stage_weights());
    SimplifyReport report;
    report.version = version();
    report.options = options;
    report.options.memory_bytes = context.budget().limit();
    report.options.n_threads = context.n_threads();
    StageLog stages(context, [&] { return source.bytes_read(); });

    cluster::CellStore store;
    StartMesh start_mesh = make_start_mesh(context, source, options, stages, store, report);
    Clusters& clusters = start_mesh.clusters;
    ManifoldMesh& manifold = start_mesh.manifold;
    report.refined_clusters = clusters.size();
    store.cells.release();
    store.attributes.release();
    store.triangles.release();
    const bool is_closed = store.n_border_cells == 0;
    if (manifold.triangles.empty()) {
        throw InvalidArgument(
            source.info().name +
            ": nothing is left of the surface at this cell size; use a finer one");
    }
    CollapseMesh mesh = make_collapse_mesh(context, clusters, manifold);
    clusters.positions.release();
    clusters.quadrics.release();
    clusters.boxes.release();
    clusters.attributes.release();
    std::optional<EdgeCollapse> collapse(std::in_place, context, std::move(mesh));

    const SourceInfo& info = source.info();
    std::vector<Target> targets = options.targets;
    const bool is_free = targets.empty();  // uniform with a given cell: everything goes out
    if (is_free) targets.push_back({Target::Kind::Ratio, 1});
    LodWriter writer(context,
                     {store, clusters.cluster_of_cell, manifold.cluster_of_vertex,
                      clusters.n_clusters, clusters.origin, info.has_normals, info.has_colors,
                      info.has_alpha, info.has_double_positions},
                     *collapse);
    std::vector<LodParents> all_parents;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        LodReport lod;
        lod.target = targets[i];
        if (!is_free) {
            const CollapseTarget target = collapse_target(targets[i], report, store);
            const bool is_budget = !target.most_displacement;
            if (is_budget && target.most_vertices == std::numeric_limits<std::uint64_t>::max()) {
                lod.target_triangles = target.most_triangles;
            }
            stages.begin("finish", collapse->n_expected(target), "collapses");
            report.collapses += collapse->run(target);
            // What the topology does not allow to collapse: components go first, then handles.
            if (is_budget) collapse->drop_components(target);
            while (is_budget && !collapse->is_met(target)) {
                MergedMesh merged = merge_regardless(
                    context, *collapse, std::max<std::uint64_t>(1, collapse->n_needed(target) / 2),
                    is_closed);
                if (merged.mesh.triangles.empty()) break;
                adopt(context, merged, clusters, manifold);
                collapse.emplace(context, std::move(merged.mesh));
                writer.rebase(*collapse, clusters.n_clusters, merged.class_of_old_vertex.span());
                lod.is_nested = false;
                report.collapses += collapse->run(target);
                collapse->drop_components(target);
            }
        }
        stages.begin("write", 0, "bytes");
        const std::unique_ptr<MeshSink> sink = sinks(i);
        writer.write(*sink, lod);
        sink->finish();
        lod.bytes = sink->bytes_written();
        stages.add_bytes_written(lod.bytes);
        report.bytes_written += lod.bytes;
        report.lods.push_back(std::move(lod));
        if (i > 0 && parents) all_parents.push_back(writer.parents());
    }
    stages.end();
    for (std::size_t i = 0; i < all_parents.size(); ++i) parents(i, all_parents[i]);

    report.stages = stages.stages();
    report.warnings = context.warnings();
    report.bytes_read = source.bytes_read();
    report.peak_budget_bytes = stages.peak_budget_bytes();
    report.peak_resident_bytes = ooc::peak_resident_bytes();
    report.result_hash = hex(writer.hash());
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

Mesh simplify_mesh(const Mesh& mesh, const SimplifyOptions& options, const Hooks& hooks) {
    if (options.targets.size() > 1) {
        throw InvalidArgument("simplify_mesh() makes one LOD; use simplify() for several");
    }
    Mesh result;
    const auto source = view_mesh(mesh);
    simplify(
        *source, [&](std::size_t) { return collect_mesh(result); }, options, hooks);
    return result;
}

}  // namespace hewer
