// SPDX-License-Identifier: MIT
#include "rsimp/lod_chain.h"

#include "rsimp/folded_faces.h"
#include "rsimp/mesh_topology.h"
#include "rsimp/topology_change.h"

namespace hewer::rsimp {

namespace {

// Of the RMS distance of the fit: how far a vertex may go for a face to be turned back. On a cliff
// a folded face is nearer to the surface than what a long move makes of it (lidar_tin_fsite7 at 20
// %: RMS .188 with moves of any length, .056 without moves).
constexpr double kMostUnfolding = 3;

}  // namespace

namespace {

bool is_met(const MeshStore& mesh, const CollapseTarget& target) {
    return mesh.faces.size() <= target.most_triangles &&
           mesh.vertices.size() <= target.most_vertices;
}

}  // namespace

LodChain::LodChain(ooc::Context& context, StartMesh start, bool with_merges)
    : context_(context),
      start_(std::move(start)),
      with_merges_(with_merges),
      report_(std::move(start_.finish)) {}

TopologyReport LodChain::keep_topology() {
    is_kept_ = true;
    is_first_ = false;
    mesh_ = start_.finisher->run({}, false, report_);
    return count_topology(context_, mesh_);
}

LodChain::Result LodChain::next(const std::optional<CollapseTarget>& target) {
    Result result;
    report_.merges.clear();
    Finisher& finisher = *start_.finisher;
    const auto collapse = [&] {
        if (!is_first_) finisher.begin(StoreInput(mesh_, finisher.first_cluster()), report_);
        is_first_ = false;
        mesh_ = finisher.run(target, with_merges_, report_);
    };
    if (start_.finished) {
        mesh_ = std::move(*start_.finished);
        start_.finished.reset();
        is_first_ = false;
    } else {
        report_.collapses = 0;
        collapse();
    }
    if (target && !target->rules.most_displacement) {
        while (!is_met(mesh_, *target) && !mesh_.faces.empty()) {
            const std::uint64_t before = report_.collapses;
            collapse();
            if (report_.collapses > before || is_met(mesh_, *target)) continue;
            if (is_kept_) {
                result.is_met = false;
                break;
            }
            const std::uint64_t n_faces = mesh_.faces.size();
            change_topology(*target, result);
            if (mesh_.faces.size() == n_faces) break;
        }
    }
    result.collapses = report_.collapses;
    return result;
}

FitReport LodChain::fit(const FitSteps& steps, double cell_size) {
    FitReport report;
    rsimp::fit(context_, mesh_, start_.samples, start_.borders, start_.finisher->boxes(),
               start_.finisher->first_cluster(), lost_cells(), steps, report);
    fit_distance_ = report.distance;
    report.first_move *= cell_size;
    report.last_move *= cell_size;
    report.distance *= cell_size;
    return report;
}

FoldedFaces LodChain::unfold(bool may_move) {
    return unfold_faces(context_, mesh_, start_.samples, start_.finisher->boxes(),
                        start_.finisher->first_cluster(),
                        may_move ? kMostUnfolding * fit_distance_ : 0,
                        {start_.to_model(mesh_.origin), start_.grid.cell_size(start_.lattice)});
}

void LodChain::change_topology(const CollapseTarget& target, Result& result) {
    WholeMesh whole(context_, mesh_);
    whole.drop_components(target, report_);
    if (!whole.is_met(target) && whole.merge_regardless(target, start_.is_closed, report_)) {
        result.is_nested = false;
    }
    mesh_ = whole.store();
}

}  // namespace hewer::rsimp
