// SPDX-License-Identifier: MIT
/// Components, borders and fans of a finished mesh of any size.
#pragma once

#include "hewer/report.h"
#include "ooc/context.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// What LodOutput counts while it writes, of a mesh that is not written: one pass over the
/// vertices, one over the faces. Memory: IdIndex, TopologyCounter, a window of faces (6 MiB) for
/// each thread and one more.
TopologyReport count_topology(ooc::Context& context, const MeshStore& mesh);

}  // namespace hewer::rsimp
