// SPDX-License-Identifier: MIT
#include "rsimp/start_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "ooc/vec3.h"
#include "rsimp/clustering.h"
#include "rsimp/grid_choice.h"
#include "rsimp/octree_fusion.h"
#include "rsimp/refiner.h"

namespace hewer::rsimp {

namespace {

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
// How far the fans of a cut vertex move towards their own neighbours, so that sheets do not touch.
constexpr double kNudge = 0.02;
// Cells of the next grid for each cell of one that was too coarse.
constexpr double kFinerGrid = 4;
// The first splits of an error-bound run stop at this part of the bound; the collapse uses up the
// rest.
constexpr double kErrorShareOfTree = 0.5;
Priority priority_of(const SimplifyOptions& options) {
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
    stages.begin("refine", static_cast<std::uint64_t>(wanted), "clusters");
    std::optional<Refiner> refiner;
    for (;;) {
        const bool is_all = wanted * kWorthRefining >= n_cells;
        if (!is_all && !refiner) refiner.emplace(context, store, priority_of(options));
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

/// Cells whose cluster no vertex stands for.
bool has_lost_cells(ooc::Context& context, const StartMesh& start) {
    ooc::Array<std::uint8_t> has_vertex(context.budget(), "clusters", start.clusters.size());
    for (const std::uint32_t c : start.manifold.cluster_of_vertex) has_vertex[c] = 1;
    return std::any_of(has_vertex.begin(), has_vertex.end(), [](std::uint8_t x) { return x == 0; });
}

/// No cluster reaches farther than half of the error bound; if some vanish nevertheless, every cell
/// becomes a cluster, and the collapse alone decides what goes.
StartMesh refine_to_error(ooc::Context& context, cluster::CellStore& store, double error,
                          StageLog& stages) {
    stages.begin("refine", 0, "clusters");
    Refiner refiner(context, store, Priority::Displacement);
    const double key = kErrorShareOfTree * error / store.grid.cell_size(store.lattice);
    StartMesh start = build_start_mesh(context, store, refiner.refine_to_key(key));
    if (!has_lost_cells(context, start)) return start;
    start = {};
    return build_start_mesh(context, store, refiner.refine_to_key(0));
}

}  // namespace

StartMesh make_start_mesh(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
                          StageLog& stages, cluster::CellStore& store, SimplifyReport& report) {
    const bool is_given = options.cell_size || options.method == Method::Full;
    for (double finer = 1;; finer *= kFinerGrid) {
        bool is_finest = false;
        store = {};
        store = cluster_input(context, source, options, finer, stages, report, is_finest);
        is_finest |= is_given;
        const double error = options.targets.empty()
                                 ? 0
                                 : target_error(options.targets.front(), report.input.bounds);
        if (error > 0) {
            StartMesh start = refine_to_error(context, store, error, stages);
            if (is_finest || !has_lost_cells(context, start)) return start;
            continue;
        }
        const bool is_uniform = options.method == Method::Uniform;
        StartMesh start = is_uniform ? fuse_to_budget(context, store, options, stages, report)
                                     : refine_to_budget(context, store, options, stages, report);
        const double enough =
            (is_uniform ? kUniformLeast : kEnoughTriangles) * budget(options, report);
        if (is_finest || static_cast<double>(start.manifold.triangles.size()) >= enough)
            return start;
    }
}

CollapseMesh make_collapse_mesh(ooc::Context& context, const Clusters& clusters,
                                ManifoldMesh& manifold) {
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
        struct Nudge {
            Vec3 pull{};  // sum of the vectors to the neighbours
            double n = 0;
            Vec3 normal{};  // of the fan, as long as its area
        };
        ooc::Array<Nudge> nudges(context.budget(), "fans", n);
        for (const CellTriple& t : mesh.triangles) {
            std::array<Vec3, 3> p;
            for (std::size_t i = 0; i < 3; ++i) {
                p[i] = clusters.positions[manifold.cluster_of_vertex[t[i]]];
            }
            const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
            for (std::size_t i = 0; i < 3; ++i) {
                if (n_fans[manifold.cluster_of_vertex[t[i]]] < 2) continue;
                Nudge& nudge = nudges[t[i]];
                nudge.pull = nudge.pull + (p[(i + 1) % 3] - p[i]) + (p[(i + 2) % 3] - p[i]);
                nudge.n += 2;
                nudge.normal = nudge.normal + normal;
            }
        }
        for (std::uint64_t v = 0; v < n; ++v) {
            const Nudge& nudge = nudges[v];
            if (nudge.n == 0) continue;
            Vec3& position = mesh.vertices[v].position;
            position = position + (kNudge / nudge.n) * nudge.pull;
            // The two sides of a folded sheet have the same neighbours: outwards they part.
            const double area = std::sqrt(dot(nudge.normal, nudge.normal));
            if (area > 0) position = position + (kNudge / 4 / std::sqrt(area)) * nudge.normal;
        }
    }
    return mesh;
}

}  // namespace hewer::rsimp
