// SPDX-License-Identifier: MIT
/// From a block and the log of its collapses to what is finished of it and what is not yet.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "rsimp/block_mesh.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

/// Merges vertices as the first steps of a log say. Nothing is decided here, so it costs next to
/// nothing. `merges`, if given, receives (id that went, id that stands for it). Returns the
/// components that vanished.
std::vector<LostPart> apply_steps(BlockMesh& mesh, std::span<const CollapseStep> steps,
                                  std::vector<std::pair<VertexId, VertexId>>* merges);

/// A block cut in two. The core is finished. The rim is what lies within kRimRings edges of a
/// frozen vertex: it goes on, together with the rims of the neighbours, into a larger block in
/// which those vertices are free. The vertices on the cut belong to the core; the rim has locked
/// copies.
struct CoreAndRim {
    static constexpr int kRimRings = 3;
    BlockMesh core;
    BlockMesh rim;
};
CoreAndRim split_rim(BlockMesh mesh);

}  // namespace hewer::rsimp
