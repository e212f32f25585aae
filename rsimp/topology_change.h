// SPDX-License-Identifier: MIT
/// Below what its topology allows: merging vertices regardless of handles and components.
#pragma once

#include <cstdint>

#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/edge_collapse.h"

namespace hewer::rsimp {

struct MergedMesh {
    CollapseMesh mesh;
    ooc::Array<std::uint32_t> class_of_vertex;  ///< of `mesh`; several vertices may share a class
    ooc::Array<std::uint32_t> class_of_old_vertex;  ///< kNoIndex: its component had been dropped
    std::uint64_t n_classes = 0;
};

/// Merges the ends of the cheapest edges, each vertex at most once and at most `n_merges` pairs,
/// without asking for the type of the surface, and makes what is left manifold again
/// (build_manifold): handles close and thin parts vanish, but nothing is opened. For targets that a
/// collapse cannot reach. Memory: as build_manifold() and a new CollapseMesh.
MergedMesh merge_regardless(ooc::Context& context, const EdgeCollapse& collapse,
                            std::uint64_t n_merges, bool is_closed);

}  // namespace hewer::rsimp
