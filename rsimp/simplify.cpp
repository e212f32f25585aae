// SPDX-License-Identifier: MIT
/// The pipeline: input -> cells -> clusters -> finishing collapse -> LODs.
#include "hewer/simplify.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "hewer/topology_limit.h"
#include "hewer/version.h"
#include "ooc/context.h"
#include "ooc/resource_usage.h"
#include "rsimp/copy.h"
#include "rsimp/grid_choice.h"
#include "rsimp/lod_chain.h"
#include "rsimp/lod_output.h"
#include "rsimp/memory_model.h"
#include "rsimp/stage_log.h"
#include "rsimp/start_mesh.h"
#include "streaming/topology_scan.h"

namespace hewer {

namespace {

using namespace rsimp;

// Expected shares of the time, for progress.
std::vector<ooc::StageWeight> stage_weights(const SimplifyOptions& options) {
    std::vector<ooc::StageWeight> weights{{"bounds", 1},   {"vertices", 2}, {"sample", 2},
                                          {"cluster", 8},  {"refine", 8},   {"triangles", 8},
                                          {"feedback", 8}, {"mesh", 2},     {"finish", 12},
                                          {"fit", 12},     {"unfold", 2},   {"write", 2}};
    if (options.color_weight > 0 || options.normal_weight > 0) weights.push_back({"attributes", 1});
    if (options.topology_report || options.topology == Topology::Keep) {
        weights.push_back({"topology", 30});
    }
    return weights;
}

bool is_same(const TopologyReport& a, const TopologyReport& b) {
    return a.components == b.components && a.euler == b.euler && a.border_loops == b.border_loops;
}

std::string in_words(const TopologyReport& t) {
    return std::to_string(t.components) + " components, " + std::to_string(t.border_loops) +
           " border loops and an Euler characteristic of " + std::to_string(t.euler);
}

/// Vertices of equal positions are one vertex for the pipeline, and what is not manifold is taken
/// apart before anything collapses: whoever counts the input by its indices should know.
void compare_to_input(ooc::Context& context, const SourceInfo& info, const TopologyReport& input,
                      const TopologyReport& kept) {
    if (is_same(input, kept)) return;
    context.warn(info.name + ": by its indices it has " + in_words(input) +
                 "; with vertices of equal positions as one, and taken apart where it is not "
                 "manifold, " +
                 in_words(kept) + ": that is what is kept");
}

[[noreturn]] void refuse(const SourceInfo& info, const std::vector<Target>& targets, std::size_t i,
                         const MeshStore& mesh) {
    const std::uint64_t n = mesh.faces.size();
    throw TopologyLimit(
        info.name + ": its topology cannot be kept with so few triangles" +
            (targets.size() > 1 ? " as level " + std::to_string(i) + " asks for" : "") +
            "; it needs at least " + std::to_string(n) + " triangles (" +
            std::to_string(mesh.vertices.size()) +
            " vertices); ask for as many, or let small parts and handles go "
            "with --topology simplify",
        n);
}

void finish_lod(MeshSink& sink, LodReport& lod, StageLog& stages, SimplifyReport& report) {
    sink.finish();
    lod.quantization = sink.displacement();
    lod.error_bound += lod.quantization;
    lod.bytes = sink.bytes_written();
    stages.add_bytes_written(lod.bytes);
    report.bytes_written += lod.bytes;
    report.lods.push_back(std::move(lod));
}

}  // namespace

SimplifyReport simplify(MeshSource& source, const SinkFactory& sinks, const SimplifyOptions& asked,
                        const Hooks& hooks, const ParentsCallback& parents) {
    const auto start = std::chrono::steady_clock::now();
    check_options(asked);
    SimplifyOptions options = asked;
    options.method = method_for(asked, source.info());
    require_memory(options, source.info());
    ooc::Context context({.memory_bytes = options.memory_bytes,
                          .n_threads = options.n_threads,
                          .temp_dir = options.temp_dir,
                          .max_temp_bytes = options.max_temp_bytes,
                          .page_bytes = options.tuning.page_bytes,
                          .sort_bytes = options.tuning.sort_bytes,
                          .spills_at_once = options.tuning.spills_at_once},
                         hooks, stage_weights(options));
    const ooc::HeldInput held = context.hold(source);
    const ooc::Reservation slack =
        context.budget().reserve("slack", slack_bytes(context.budget().limit()));
    SimplifyReport report;
    report.version = version();
    report.options = options;
    report.options.memory_bytes = context.budget().limit();
    report.options.n_threads = context.n_threads();
    StageLog stages(context, [&] { return source.bytes_read(); });

    std::optional<TopologyReport> input_topology;
    if (options.topology_report || options.topology == Topology::Keep) {
        stages.begin("topology", source.info().n_faces, "faces");
        input_topology = streaming::count_topology(context, source);
        ++report.input.triangle_passes;
    }
    const auto finish_report = [&](const ooc::ResultHash& hash) {
        report.stages = stages.stages();
        report.warnings = context.warnings();
        report.bytes_read = source.bytes_read();
        report.peak_budget_bytes = stages.peak_budget_bytes();
        report.peak_temp_bytes = context.spill().peak();
        report.temp_bytes_written = context.spill().bytes_written();
        report.temp_bytes_read = context.spill().bytes_read();
        report.peak_resident_bytes = ooc::peak_resident_bytes();
        report.result_hash = hash.hex();
        report.input.opening_seconds = source.opening_seconds();
        report.seconds =
            source.opening_seconds() +
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    if (options.method == Method::Copy) {
        LodReport lod;
        lod.target = {Target::Kind::Ratio, 1};
        const std::unique_ptr<MeshSink> sink = sinks(0);
        const ooc::ResultHash hash =
            copy_mesh(context, source, *sink, options, stages, report, lod);
        lod.target_triangles = lod.triangles;
        finish_lod(*sink, lod, stages, report);
        report.input.topology = input_topology;
        stages.end();
        finish_report(hash);
        return report;
    }
    StartMesh start_mesh = make_start_mesh(context, source, options, stages, report);
    report.input.topology = input_topology;
    report.refined_clusters = start_mesh.n_clusters;
    const SourceInfo& info = source.info();
    // The samples know nothing of colours, whose borders run along edges then.
    const bool weighs_attributes = start_mesh.scales.color > 0 || start_mesh.scales.normal > 0;
    LodOutput output(context,
                     {start_mesh.lattice, start_mesh.grid, info.has_normals, info.has_colors,
                      info.has_alpha, info.has_double_positions, start_mesh.scales},
                     static_cast<bool>(parents));
    LodChain chain(context, std::move(start_mesh), static_cast<bool>(parents));
    if (options.topology == Topology::Keep) {
        stages.begin("finish", 0, "collapses");
        report.kept_topology = chain.keep_topology();
        compare_to_input(context, source.info(), *input_topology, *report.kept_topology);
    }
    std::vector<Target> targets = options.targets;
    const bool is_free = targets.empty();  // uniform with a given cell: everything goes out
    if (is_free) targets.push_back({Target::Kind::Ratio, 1});
    std::vector<LodParents> all_parents;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        LodReport lod;
        lod.target = targets[i];
        std::optional<CollapseTarget> target;
        if (!is_free) {
            target = collapse_target(targets[i], report);
            if (!target->rules.most_displacement &&
                target->most_vertices == std::numeric_limits<std::uint64_t>::max()) {
                lod.target_triangles = target->most_triangles;
            }
        }
        stages.begin("finish", 0, "collapses");
        const LodChain::Result result = chain.next(target);
        lod.is_nested = result.is_nested;
        if (!result.is_met) refuse(source.info(), targets, i, chain.mesh());
        report.collapses += result.collapses;
        if (chain.mesh().faces.empty()) {
            throw InvalidArgument(
                source.info().name +
                ": nothing is left of the surface at this cell size; use a finer one");
        }
        if (const unsigned rounds = fit_rounds(options); rounds > 0) {
            stages.begin("fit", rounds * chain.mesh().vertices.size(), "vertices");
            lod.fit = chain.fit({rounds, i == 0 && !weighs_attributes}, report.grid.cell_size);
        }
        if (options.method != Method::Uniform) {
            stages.begin("unfold", 0, "faces");
            lod.folded = chain.unfold(!(target && target->rules.most_displacement));
        }
        stages.begin("write", 0, "bytes");
        const std::unique_ptr<MeshSink> sink = sinks(i);
        output.write(chain.mesh(), *sink, lod);
        if (report.kept_topology && !is_same(lod.topology, *report.kept_topology)) {
            throw InternalError("the topology was to stay, and did not");
        }
        if (report.aggregate) lod.error_bound += report.aggregate->distance;
        lod.lost_cells = chain.lost_cells();
        lod.lost = chain.lost_places();
        finish_lod(*sink, lod, stages, report);
        if (i > 0 && parents) all_parents.push_back(output.parents(chain.merges()));
    }
    report.joined_necks = chain.joined_necks();
    stages.end();
    for (std::size_t i = 0; i < all_parents.size(); ++i) parents(i, all_parents[i]);

    finish_report(output.hash());
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
