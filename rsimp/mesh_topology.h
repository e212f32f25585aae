// SPDX-License-Identifier: MIT
/// Edges and components of an indexed mesh that need not fit in memory.
#pragma once

#include <array>
#include <cstdint>

#include "hewer/report.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// Counts what a reader of the file would. Faces near each other should use vertices near each
/// other: edges are settled in windows of faces, and only those whose ends are both used by several
/// windows are sorted. Two passes over the faces. Memory: 4.25 bytes a vertex, and for each window
/// at work 1.6 MiB.
TopologyReport count_topology(ooc::Context& context,
                              const ooc::Spool<std::array<std::uint32_t, 3>>& faces,
                              std::uint64_t n_vertices);

}  // namespace hewer::rsimp
