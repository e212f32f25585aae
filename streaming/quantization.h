// SPDX-License-Identifier: MIT
/// Which step positions are rounded to.
#pragma once

#include <cstdint>

#include "hewer/mesh_sink.h"

namespace hewer::streaming {

constexpr unsigned kMostDracoBits = 30;
constexpr unsigned kMostGltfBits = 16;

/// The step that `wanted` means for such a mesh, model units; 0: none is wanted, or none is known
/// to be fine enough. Automatic: a tenth of the mesh's own error.
double wanted_step(const Quantization& wanted, const SinkHeader& header);

/// Bits for the longest side of the box at that step or a finer one, at most 30.
unsigned bits_for(double step, const Bounds& bounds);

/// Of the grid with 2^bits points on the longest side.
double step_of(unsigned bits, const Bounds& bounds);

}  // namespace hewer::streaming
