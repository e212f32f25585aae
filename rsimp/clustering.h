// SPDX-License-Identifier: MIT
/// The first half of the pipeline: passes over the input, up to the blocks of cells.
#pragma once

#include "cluster/cell_blocks.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

/// Passes: vertices (for double positions bounds first, unless given), triangles; a soup has its
/// corners sampled in a pass of its own, and vertex attributes are added in one more pass over the
/// vertices. Fills report.input and report.grid. Throws FormatError if no usable triangle is found.
///
/// @param finer      factor on the number of cells that the target calls for.
/// @param is_finest  set if no grid could separate more of the input's vertices.
cluster::CellBlocks cluster_input(ooc::Context& context, MeshSource& source,
                                  const SimplifyOptions& options, double finer, StageLog& stages,
                                  SimplifyReport& report, bool& is_finest);

}  // namespace hewer::rsimp
