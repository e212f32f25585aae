// SPDX-License-Identifier: MIT
/// Faces of a finished mesh that show the original surface their back.
#pragma once

#include <cstdint>
#include <span>

#include "cluster/cell_blocks.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/fit_samples.h"
#include "rsimp/lost_parts.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A face is folded if the part of the original that is nearest to its centre faces the other way:
/// there is a sample turned by more than 90 degrees from it, and none that is not within one and a
/// half times that distance, nor within the mean distance between samples (a sheet's other side is
/// no fold). A face without any sample within the mean distance between vertices stands for nothing
/// that is there and is not judged; nor is one without area. Collapses turn faces by up to 78
/// degrees each, and merging cells by any angle, so folds come about however careful each step is.
///
/// They are turned back where that is cheap: a corner of a folded face goes a quarter, a half, ...
/// of the way to the middle of its neighbours, but not farther than `most_move` cells in a step, if
/// fewer of its faces are folded then, and none turns by more than 90 degrees that was not. Border
/// vertices stay. Only vertices whose neighbours are all of the same region (rsimp/mesh_regions.h)
/// move, so regions do not meet and neither threads nor memory show.
///
/// `boxes` and `first_cluster` as for fit(). Two passes over the faces (three where vertices move),
/// one over the samples, a second over those near folded faces. Memory: MeshRegions, SampleRuns,
/// and for each region in work 40 bytes a face more.
FoldedFaces unfold_faces(ooc::Context& context, MeshStore& mesh,
                         const ooc::Spool<FitSample>& samples,
                         std::span<const cluster::OctreeBox> boxes,
                         std::span<const std::uint64_t> first_cluster, double most_move,
                         const PlaceFrame& frame);

}  // namespace hewer::rsimp
