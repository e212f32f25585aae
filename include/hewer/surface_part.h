// SPDX-License-Identifier: MIT
/// What of a surface is near some places.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer {

/// The triangles of `surface` whose boxes touch any of `boxes`, each with corners of its own;
/// nothing if there are more than `most_triangles`. Their order depends on themselves alone.
///
/// One pass over the surface, which is never in memory. Memory: 96 bytes for each triangle that is
/// returned, 72 more until then, and a window over the surface's vertices.
/// Meant for some hundreds of boxes: each is looked at for every 64 triangles, and with each of
/// these if it touches them. Of `options`, memory, threads and temporary space are used. Throws: as
/// measure().
std::optional<Mesh> part_of_surface(MeshSource& surface, std::span<const Bounds> boxes,
                                    std::uint64_t most_triangles,
                                    const MeasureOptions& options = {}, const Hooks& hooks = {});

}  // namespace hewer
