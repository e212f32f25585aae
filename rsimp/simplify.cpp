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
#include "rsimp/clustering.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/grid_choice.h"
#include "rsimp/lod.h"
#include "rsimp/manifold.h"
#include "rsimp/octree_fusion.h"
#include "rsimp/refiner.h"
#include "rsimp/stage_log.h"

namespace hewer {

namespace {

using namespace rsimp;

// Expected shares of the time, for progress.
const std::vector<ooc::StageWeight> kStages{{"bounds", 1},  {"vertices", 2}, {"sample", 2},
                                            {"cluster", 8}, {"refine", 8},   {"mesh", 2},
                                            {"finish", 12}, {"write", 2}};

// With fewer cells than this times the clusters wanted, the collapse begins with the cells
// themselves.
constexpr double kWorthRefining = 1.3;
// Triangles that the collapse must at least begin with, for each that is asked for.
constexpr double kEnoughTriangles = 1.25;
// Share of the budget that the uniform method aims at and is content with, and the factor on its
// clusters when it falls short.
constexpr double kUniformAim = 0.985;
constexpr double kUniformLeast = 0.85;
constexpr double kMoreClusters = 1.15;
// Cells of the next grid for each cell of one that was too coarse.
constexpr double kFinerGrid = 4;
// The first splits of an error-bound run stop at this part of the bound; the collapse uses up the
// rest.
constexpr double kErrorShareOfTree = 0.5;
// How far the fans of a cut vertex move towards their own neighbours, so that sheets do not touch.
constexpr double kNudge = 0.02;

Priority priority_of(const SimplifyOptions& options, bool is_error_run) {
    if (is_error_run) return Priority::Displacement;
    return options.priority == SplitPriority::NormalVariation ? Priority::NormalVariation
                                                              : Priority::Quadric;
}

/// A budget in triangles; 0 for error bounds and where everything goes out.
double budget(const SimplifyOptions& options, const SimplifyReport& report) {
    if (options.targets.empty()) return 0;
    return 2 * target_vertices(options.targets.front(), report.input.triangles);
}

/// The cell triples as triples of clusters, those left out that have collapsed.
ooc::Array<CellTriple> surviving_triples(ooc::Context& context, const cluster::CellStore& store,
                                         const Clusters& clusters) {
    const auto map = [&](const CellTriple& t) -> CellTriple {
        return {clusters.cluster_of_cell[t[0]], clusters.cluster_of_cell[t[1]],
                clusters.cluster_of_cell[t[2]]};
    };
    const auto survives = [](const CellTriple& t) {
        return t[0] != t[1] && t[1] != t[2] && t[0] != t[2];
    };
    std::uint64_t n = 0;
    for (const CellTriple& t : store.triangles) n += survives(map(t)) ? 1U : 0U;
    ooc::Array<CellTriple> triples(context.budget(), "cluster triples", n);
    n = 0;
    for (const CellTriple& t : store.triangles) {
        const CellTriple mapped = map(t);
        if (survives(mapped)) triples[n++] = mapped;
    }
    return triples;
}

/// What the collapse begins with.
struct StartMesh {
    Clusters clusters;
    ManifoldMesh manifold;
};

StartMesh build_start_mesh(ooc::Context& context, const cluster::CellStore& store,
                           Clusters clusters) {
    const ooc::Array<CellTriple> triples = surviving_triples(context, store, clusters);
    const bool is_closed = store.n_border_cells == 0;
    ManifoldMesh manifold =
        build_manifold(context, triples.span(), clusters.positions.span(), is_closed);
    return {std::move(clusters), std::move(manifold)};
}

/// Refines until the mesh has enough triangles for the collapse to choose from. How many a cluster
/// brings is known only afterwards: two on a closed surface, next to none where thin parts or many
/// small components vanish in their clusters.
StartMesh refine_to_budget(ooc::Context& context, cluster::CellStore& store,
                           const SimplifyOptions& options, StageLog& stages,
                           const SimplifyReport& report) {
    const double triangles = budget(options, report);
    const auto n_cells = static_cast<double>(store.codes.size());
    double wanted = std::ceil(kClustersPerVertex * triangles / 2);
    stages.begin("refine", 0, "clusters");
    std::optional<Refiner> refiner;
    for (;;) {
        const bool is_all = wanted * kWorthRefining >= n_cells;
        if (!is_all && !refiner) refiner.emplace(context, store, priority_of(options, false));
        StartMesh start = build_start_mesh(
            context, store,
            is_all && !refiner
                ? clusters_from_cells(context, store)
                : refiner->refine_to_count(static_cast<std::uint64_t>(is_all ? n_cells : wanted)));
        const auto n = static_cast<double>(start.manifold.triangles.size());
        if (is_all || n >= kEnoughTriangles * triangles) return start;
        wanted *= std::clamp(kClustersPerVertex * triangles / std::max(n, 1.0), 1.5, 8.0);
    }
}

/// The uniform method: as many clusters as a closed surface needs for the budget. Where parts
/// vanish in their clusters that is too few, and more are allowed.
StartMesh fuse_to_budget(ooc::Context& context, const cluster::CellStore& store,
                         const SimplifyOptions& options, StageLog& stages,
                         const SimplifyReport& report) {
    stages.begin("refine", 0, "clusters");
    const double triangles = budget(options, report);
    if (triangles == 0) {
        return build_start_mesh(context, store, clusters_from_cells(context, store));
    }
    for (double wanted = kUniformAim * triangles / 2;; wanted *= kMoreClusters) {
        StartMesh start = build_start_mesh(
            context, store, fuse_cells(context, store, static_cast<std::uint64_t>(wanted)));
        const auto n = static_cast<double>(start.manifold.triangles.size());
        if (n >= kUniformLeast * triangles || wanted >= static_cast<double>(store.codes.size())) {
            return start;
        }
    }
}

StartMesh make_start_mesh(ooc::Context& context, cluster::CellStore& store,
                          const SimplifyOptions& options, StageLog& stages,
                          const SimplifyReport& report) {
    if (options.method == Method::Uniform)
        return fuse_to_budget(context, store, options, stages, report);
    const double error = target_error(options.targets.front(), report.input.bounds);
    if (error == 0) return refine_to_budget(context, store, options, stages, report);
    stages.begin("refine", 0, "clusters");
    Refiner refiner(context, store, priority_of(options, true));
    const double cell = store.grid.cell_size(store.lattice);
    return build_start_mesh(context, store,
                            refiner.refine_to_key(kErrorShareOfTree * error / cell));
}

/// Clusters the input, on a finer grid again if the first one has swallowed so much (parts thinner
/// than a cell, thousands of small components) that the budget cannot be met from it.
StartMesh cluster_and_refine(ooc::Context& context, MeshSource& source,
                             const SimplifyOptions& options, StageLog& stages,
                             cluster::CellStore& store, SimplifyReport& report) {
    const bool is_given = options.cell_size || options.method == Method::Full;
    for (double finer = 1;; finer *= kFinerGrid) {
        bool is_finest = false;
        store = cluster_input(context, source, options, finer, stages, report, is_finest);
        StartMesh start = make_start_mesh(context, store, options, stages, report);
        const double triangles = budget(options, report);
        const auto n = static_cast<double>(start.manifold.triangles.size());
        const bool is_enough =
            n >= (options.method == Method::Uniform ? kUniformLeast : kEnoughTriangles) * triangles;
        if (is_enough || is_finest || is_given) return start;
    }
}

/// Gives every vertex of the manifold mesh its cluster's place and quadric. Vertices that share a
/// cluster share its quadric, and step apart.
CollapseMesh make_collapse_mesh(ooc::Context& context, Clusters& clusters, ManifoldMesh& manifold) {
    const std::uint64_t n = manifold.cluster_of_vertex.size();
    CollapseMesh mesh;
    mesh.triangles = std::move(manifold.triangles);
    mesh.vertices = {context.budget(), "mesh vertices", n};
    if (!clusters.attributes.empty()) mesh.attributes = {context.budget(), "mesh attributes", n};
    ooc::Array<std::uint32_t> n_fans(context.budget(), "fans", clusters.size());
    for (const std::uint32_t c : manifold.cluster_of_vertex) ++n_fans[c];
    for (std::uint64_t v = 0; v < n; ++v) {
        const std::uint32_t c = manifold.cluster_of_vertex[v];
        CollapseVertex& vertex = mesh.vertices[v];
        vertex = {clusters.positions[c], clusters.quadrics[c], clusters.boxes[c]};
        if (!mesh.attributes.empty()) mesh.attributes[v] = clusters.attributes[c];
        if (n_fans[c] > 1) {
            const double share = 1.0 / n_fans[c];
            for (double& x : vertex.quadric.a) x *= share;
            for (double& x : vertex.quadric.b) x *= share;
            vertex.quadric.c *= share;
        }
    }
    if (manifold.n_cut_vertices > 0) {
        ooc::Array<std::array<double, 4>> pull(context.budget(), "fans", n);
        for (const CellTriple& t : mesh.triangles) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (n_fans[manifold.cluster_of_vertex[t[i]]] < 2) continue;
                for (const std::size_t k : {(i + 1) % 3, (i + 2) % 3}) {
                    for (std::size_t d = 0; d < 3; ++d) {
                        pull[t[i]][d] += clusters.positions[manifold.cluster_of_vertex[t[k]]][d] -
                                         clusters.positions[manifold.cluster_of_vertex[t[i]]][d];
                    }
                    pull[t[i]][3] += 1;
                }
            }
        }
        for (std::uint64_t v = 0; v < n; ++v) {
            if (pull[v][3] == 0) continue;
            for (std::size_t d = 0; d < 3; ++d) {
                mesh.vertices[v].position[d] += kNudge * pull[v][d] / pull[v][3];
            }
        }
    }
    return mesh;
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
    ooc::Context context(options.memory_bytes, options.n_threads, hooks, kStages);
    SimplifyReport report;
    report.version = version();
    report.options = options;
    report.options.memory_bytes = context.budget().limit();
    report.options.n_threads = context.n_threads();
    StageLog stages(context, [&] { return source.bytes_read(); });

    cluster::CellStore store;
    StartMesh start_mesh = cluster_and_refine(context, source, options, stages, store, report);
    Clusters& clusters = start_mesh.clusters;
    ManifoldMesh& manifold = start_mesh.manifold;
    report.refined_clusters = clusters.size();
    store.cells.release();
    store.attributes.release();
    store.triangles.release();
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
    EdgeCollapse collapse(context, std::move(mesh));

    const SourceInfo& info = source.info();
    std::vector<Target> targets = options.targets;
    const bool is_free = targets.empty();  // uniform with a given cell: everything goes out
    if (is_free) targets.push_back({Target::Kind::Ratio, 1});
    LodWriter writer(context,
                     {store, clusters.cluster_of_cell, manifold.cluster_of_vertex, clusters.size(),
                      clusters.origin, info.has_normals, info.has_colors, info.has_alpha,
                      info.has_double_positions},
                     collapse);
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
            stages.begin("finish", 0, "collapses");
            report.collapses += collapse.run(target);
            if (is_budget) collapse.drop_components(target);
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
