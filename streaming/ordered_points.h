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

using TakePoints = std::function<void(std::span<const std::array<Vec3, 3>>)>;

/// take(triangles) for pieces of them, on one thread; those with a repeated corner, or one that is
/// not finite, are left out. Memory: a quarter of the limit, or less if all vertices are in memory
/// with that. Disk, if they are not: 16 bytes a corner (28 with double positions), see CornerJoin.
/// The same result either way. Throws: as Dereference does.
///
/// @param most_resident  vertices that may be held; 0: as the limit allows. For tests.
void stream_points(ooc::Context& context, MeshSource& source, std::uint64_t most_resident,
                   const TakePoints& take);

}  // namespace hewer::streaming
