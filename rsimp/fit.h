// SPDX-License-Identifier: MIT
/// Moves the vertices of a finished mesh, as a whole, towards the original surface, and flips
/// edges.
#pragma once

#include <cstdint>
#include <span>

#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/fit_samples.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

struct FitSteps {
    unsigned rounds = 0;
    bool flips_edges = false;  ///< in every other round, before vertices move
};

/// A quadric's optimum lies near the planes around one vertex; a finished mesh can still be moved
/// as a whole, and its edges flipped (Hoppe's mesh optimisation, 1993, with a fixed number of
/// vertices). Every round flips edges (EdgeFlips), then every vertex makes the step of FitMoves, at
/// a border that of BorderMoves, all at once. Faces never fold, parts of the original that the mesh
/// has lost do not pull. The result does not depend on threads or memory. Without samples of the
/// borders these stay.
///
/// `boxes`, and the first cluster of each and the end, are those that the mesh was made in;
/// `lost_cells` are those of which the mesh has lost the surface. The
/// lengths in `report` are in cells. Per round: two passes over the faces, two more where edges
/// flip, one over the samples, each read in regions with what lies around them. Memory:
/// MeshRegions, SampleRuns, a region for each thread, with flips EdgeFlips and a sort buffer;
/// positions before and after, and moves, 72 bytes a vertex, on spools.
void fit(ooc::Context& context, MeshStore& mesh, const ooc::Spool<FitSample>& samples,
         const ooc::Spool<FitSample>& borders, std::span<const cluster::OctreeBox> boxes,
         std::span<const std::uint64_t> first_cluster, std::uint64_t lost_cells,
         const FitSteps& steps, FitReport& report);

}  // namespace hewer::rsimp
