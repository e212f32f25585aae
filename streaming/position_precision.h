// SPDX-License-Identifier: MIT
/// Whether a float is good enough for the coordinates of a mesh: one rule for all writers.
#pragma once

#include "hewer/mesh_sink.h"
#include "hewer/types.h"

namespace hewer::streaming {

/// True if rounding the coordinates to float would move a vertex by more than 1e-5 of the diagonal:
/// then the steps of the float grid show in a picture, as they do in map coordinates (at 5,000,000
/// m a float moves in steps of 0.5 m). Half a step is the largest |coordinate| times 2^-24, but
/// never less than 2^-150, half of the smallest float. Also true beyond the largest float. False
/// for an empty box.
bool float_is_too_coarse(const Bounds& bounds);

/// True if a format that has doubles (PLY) or free digits (OBJ) should use them: float is too
/// coarse and the input held doubles. From a float input the steps are there already, and twice the
/// size would only store them more precisely.
bool needs_double(const SinkHeader& header);

/// A point near the centre of the box from which float is fine again. Every coordinate is a
/// multiple of the largest power of two that is not above the diagonal, so that it has few digits
/// and, far out, is itself a float for the programs that keep it as one. The centre itself if the
/// box is a point.
Vec3 local_origin(const Bounds& bounds);

/// Throws InvalidArgument naming `path` and `format` if a coordinate is beyond the largest float.
void require_float_range(const Bounds& bounds, const std::filesystem::path& path,
                         const char* format);

}  // namespace hewer::streaming
