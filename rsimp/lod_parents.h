// SPDX-License-Identifier: MIT
/// How the vertices of one LOD and of the next coarser one belong together.
#pragma once

#include <span>
#include <utility>

#include "hewer/simplify.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Parents of the vertices of one LOD in the next one, by output indices; the largest number for a
/// vertex of which nothing is left.
///
/// @param fine, coarse  ids of the vertices of both, rising.
/// @param merges        (went, stands for it) on the way from one to the other, in order: a pair's
///                      second may be the first of a later one. A vertex that is in none of them
///                      stands for itself.
/// Memory: 16 bytes a vertex of `fine` besides the result, which has 8; both IdIndexes.
LodParents find_parents(ooc::Context& context, const ooc::Spool<VertexId>& fine,
                        std::span<const std::pair<VertexId, VertexId>> merges,
                        const ooc::Spool<VertexId>& coarse);

}  // namespace hewer::rsimp
