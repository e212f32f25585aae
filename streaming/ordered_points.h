// SPDX-License-Identifier: MIT
/// The triangles of an indexed mesh as points, in the order of the file.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "hewer/mesh_source.h"
#include "ooc/context.h"

namespace hewer::streaming {

/// take(triangles) for pieces of them; those with a repeated corner, or one that is not finite, are
/// left out. Unlike Dereference it keeps the order, on one thread.
/// Memory: 24 bytes a vertex where that is a quarter of the limit at most; else two sorts, 16 bytes
/// a corner of disk, then 32. The same result either way. Throws: as the source does,
/// OutOfDiskBudget, Cancelled.
///
/// @param most_resident  vertices that may be held; 0: as the limit allows. For tests.
void stream_points(ooc::Context& context, MeshSource& source, std::uint64_t most_resident,
                   const std::function<void(std::span<const std::array<Vec3, 3>>)>& take);

}  // namespace hewer::streaming
