// SPDX-License-Identifier: MIT
/// The levels of detail of a run, fine to coarse: each is the one before it, collapsed further.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/finish.h"
#include "rsimp/fit.h"
#include "rsimp/start_mesh.h"

namespace hewer::rsimp {

class LodChain {
  public:
    LodChain(ooc::Context& context, StartMesh start, bool with_merges);

    /// All topology is to stay from here on. Before the first next(): makes the mesh manifold,
    /// nothing more, and counts what is to be kept.
    TopologyReport keep_topology();

    struct Result {
        /// False only where topology is kept: the mesh cannot get down to the target without.
        bool is_met = true;
        bool is_nested = true;  ///< every vertex of the mesh before has one parent in this one
        std::uint64_t collapses = 0;
    };
    /// Makes the next mesh. Without a target everything is kept. A target that collapsing cannot
    /// reach is reached by dropping components, and then regardless of handles, unless topology is
    /// to stay.
    Result next(const std::optional<CollapseTarget>& target);

    /// Moves the mesh towards the original. The next mesh begins from there: edges may flip in the
    /// first one only, or the next would not be nested in it. `cell_size` is the unit of the
    /// lengths in the report.
    FitReport fit(const FitSteps& steps, double cell_size);

    /// Counts the faces that show the original their back, and, after a fit, turns them back if
    /// vertices may move (rsimp/folded_faces.h).
    FoldedFaces unfold(bool may_move);

    [[nodiscard]] const MeshStore& mesh() const { return mesh_; }
    /// Of the mesh that the chain began with (rsimp/necks.h).
    [[nodiscard]] std::uint64_t joined_necks() const { return report_.joined_necks; }
    /// Grid cells so far for which no vertex stands any more.
    [[nodiscard]] std::uint64_t lost_cells() const { return report_.lost_cells; }
    /// Places so far of which nothing is left, parts smaller than a cell included.
    [[nodiscard]] LostPlaces lost_places() const {
        return find_places(context_, report_.lost,
                           {start_.to_model(mesh_.origin), start_.grid.cell_size(start_.lattice)});
    }
    /// Which vertices went where on the way from the mesh before to this one, if asked for; in
    /// order: a pair's second may be the first of a later one.
    [[nodiscard]] const std::vector<std::pair<VertexId, VertexId>>& merges() const {
        return report_.merges;
    }

  private:
    void change_topology(const CollapseTarget& target, Result& result);

    ooc::Context& context_;
    StartMesh start_;
    bool with_merges_;
    bool is_first_ = true;
    bool is_kept_ = false;  // the topology
    FinishReport report_;
    MeshStore mesh_;
    double fit_distance_ = 0;  // RMS, in cells; 0 without a fit
};

}  // namespace hewer::rsimp
