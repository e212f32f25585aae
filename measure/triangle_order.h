// SPDX-License-Identifier: MIT
/// The order of triangles in a TriangleIndex.
#pragma once

#include <cstdint>
#include <span>

#include "measure/lattice.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Reorders `triangles` in place so that each aligned group of `leaf * 2^k` of them is one side of
/// median splits by centroid along the longest axis, for all k; leaves are sorted. `leaf` is a
/// power of two. The result depends on the set of triangles alone. O(n log n) time, no memory.
/// Throws Cancelled.
void order_by_median_splits(ooc::Context& context, std::span<LatticeTriangle> triangles,
                            std::uint64_t leaf);

}  // namespace hewer::measuring
