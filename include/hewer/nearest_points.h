// SPDX-License-Identifier: MIT
/// The points of a surface that are nearest to a few others.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer {

/// For each of `points` the nearest point of any triangle of `surface`; nothing if that is farther
/// than `most_distance`. Model units.
///
/// Two passes over the surface, which is never in memory. Memory: 56 bytes a point and thread, and
/// a window over the surface's vertices. Meant for some hundreds of points: each is looked at for
/// every 64 triangles, and with each of these if it is near them. The same for any threads. Of
/// `options`, memory, threads and temporary space are used. Throws: as measure().
std::vector<std::optional<Vec3>> nearest_points(MeshSource& surface, std::span<const Vec3> points,
                                                double most_distance,
                                                const MeasureOptions& options = {},
                                                const Hooks& hooks = {});

}  // namespace hewer
