// SPDX-License-Identifier: MIT
/// From the input to the mesh that the finishing collapse begins with: clustering, refinement, and
/// as many repetitions of either as the target needs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/attribute_fit.h"
#include "rsimp/finish.h"
#include "rsimp/fit_samples.h"
#include "rsimp/mesh_store.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

struct StartMesh {
    cluster::Lattice lattice;
    cluster::UniformGrid grid;
    AttributeScales scales;  ///< of the attribute quadrics
    bool is_closed = false;
    std::uint64_t n_clusters = 0;
    std::unique_ptr<Finisher> finisher;  ///< has begun
    FinishReport finish;                 ///< so far
    /// The first LOD, if a round of feedback has finished it; its collapses are in `finish`.
    std::optional<MeshStore> finished;
    ooc::Spool<FitSample> samples;  ///< if there is a fit
    ooc::Spool<FitSample> borders;  ///< of the borders, likewise

    [[nodiscard]] Vec3 to_model(const Vec3& in_cells) const {
        return lattice.origin() + (grid.cell_size(lattice) * in_cells);
    }
};

/// Where the collapse stops for a target; lengths in cells.
CollapseTarget collapse_target(const Target& target, const SimplifyReport& report);

/// How many clusters the target needs is known only from the mesh that they make: two triangles
/// come of each on a closed surface, next to none where thin parts or many small components vanish
/// in their clusters. So clusters are added until the collapse has enough triangles to choose from;
/// if all cells are too few, the input is clustered again on a finer grid. Rounds of feedback
/// (rsimp/feedback.h) each finish a mesh and refine again, as long as they bring something. With an
/// error bound the same is done as long as a part of the surface has vanished.
StartMesh make_start_mesh(ooc::Context& context, MeshSource& source, const SimplifyOptions& options,
                          StageLog& stages, SimplifyReport& report);

}  // namespace hewer::rsimp
