// SPDX-License-Identifier: MIT
/// Finds the places where a level of detail is far from the original, and makes them dearer to the
/// next one.
#pragma once

#include <cstdint>
#include <span>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

struct FeedbackResult {
    bool is_made = true;                    ///< else nothing here counts
    ooc::Spool<cluster::CellRecord> cells;  ///< to be put in the place of those before
    ooc::Spool<float> vanished;             ///< the same: CellBlocks::vanished
    std::uint64_t n_far = 0;
    bool has_vanished = false;  ///< some of the surface is not in the mesh at all
    /// Of the distances of the cells' means from the mesh, by area, in cells; with the bound below.
    double mean_square = 0;
    /// Largest distance of a cell's mean from the mesh, in cells; no more than two mean distances
    /// between vertices: farther is not told.
    double worst = 0;
};

/// What a round of feedback could take off is the part of the sum of squared distances that is
/// beyond the bound at which a cell is far. By one of `stride` cells: if that is less than
/// `least_share`, no round is made. 0: it is made in any case.
struct FeedbackLook {
    double least_share = 0;
    std::uint64_t stride = 1;
};

/// What a quadric cannot see: thin pieces have almost no error in any plane, whatever becomes of
/// them, so they vanish first, and a small place that is far off counts as little as its area. Here
/// the mean of each cell is measured against a finished mesh. The quadric of each that is several
/// times the common RMS away gets a heavy point quadric, area |x - mean|^2, less heavy near that
/// bound: the surface is held where it is, in all directions, and splits and collapses are chosen
/// again. The budget comes from where it is not missed.
///
/// `first_cluster` of each block of cells and the end are those that the mesh was made from.
/// Passes: one over cells and faces in regions, one over the cells. Memory: MeshRegions, and for
/// each region in work its faces and 4 bytes a cell; 8 bytes a cell on spools; a PointTree of up to
/// 65,536 vertices where something has vanished. Nothing depends on
/// threads or memory.
/// `far_distance`, in cells, takes the place of the several times if it is not 0. One pass over
/// cells and faces more for a look.
FeedbackResult feed_back(ooc::Context& context, const cluster::CellBlocks& cells,
                         const MeshStore& mesh, std::span<const std::uint64_t> first_cluster,
                         double far_distance, const FeedbackLook& look);

}  // namespace hewer::rsimp
