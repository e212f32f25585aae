// SPDX-License-Identifier: MIT
/// A mesh coloured by distance.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"
#include "measure/census.h"
#include "measure/lattice.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// The colour of `share`, 0 (dark blue) to 1 (yellow), clamped: viridis (Smith & van der Walt
/// 2015), whose steps look alike and whose lightness rises all the way.
Rgba16 ramp_color(double share);

/// distances(points, out): the distance of each point, in model units or steps; called by all
/// threads at once.
using FindDistances =
    std::function<void(std::span<const LatticePoint> points, std::span<double> out)>;

/// Streams `source` to `sink`: the triangles that count for `census` and all vertices, in the order
/// of the file; of a soup, three vertices a triangle. A vertex that counts gets the colour of
/// its distance / range, any other is grey; one that is not finite is put into a corner of the box.
/// One pass over the vertices and one over the triangles. Memory: a batch.
/// Throws: as source and sink do, Cancelled.
void write_distance_map(ooc::Context& context, MeshSource& source, const Census& census,
                        const Lattice& lattice, const FindDistances& distances, double range,
                        MeshSink& sink);

}  // namespace hewer::measuring
