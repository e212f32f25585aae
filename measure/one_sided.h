// SPDX-License-Identifier: MIT
/// Distances from one surface to another.
#pragma once

#include <cstdint>
#include <span>

#include "hewer/measure.h"
#include "measure/lattice.h"
#include "measure/surface_sampler.h"
#include "measure/triangle_index.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// From every point of `points` and every sample of `sampler`, in steps of `lattice`, to the
/// triangles of `to`; reported in model units. Sums are taken by runs of kRun points, whose results
/// are added in order: equal bits for any number of threads.
/// Memory: 64 bytes for each kRun points. Throws: OutOfMemoryBudget, Cancelled.
DistanceReport one_sided_distance(ooc::Context& context, std::span<const LatticePoint> points,
                                  const SurfaceSampler& sampler, const TriangleIndex& to,
                                  const Lattice& lattice);

/// Bytes that one_sided_distance() needs for `n` points and samples together.
std::uint64_t one_sided_bytes(std::uint64_t n);

}  // namespace hewer::measuring
