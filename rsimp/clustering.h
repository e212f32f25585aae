// SPDX-License-Identifier: MIT
/// The first half of the pipeline: passes over the input, up to the cell store.
#pragma once

#include "cluster/cell_store.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

/// Passes: bounds (unless given), vertices, triangles; a soup has its corners sampled in a pass of its
/// own, and vertex attributes are added in one more pass over the vertices.
/// Fills report.input and report.grid.
/// Throws FormatError if no usable triangle is found.
cluster::CellStore cluster_input(ooc::Context& context, MeshSource& source,
                                 const SimplifyOptions& options, StageLog& stages,
                                 SimplifyReport& report);

}  // namespace hewer::rsimp
