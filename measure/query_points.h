// SPDX-License-Identifier: MIT
/// The points of a resident surface that are measured from.
#pragma once

#include <cstdint>
#include <span>

#include "hewer/types.h"
#include "measure/area_sampler.h"
#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// In steps: first the vertices, then the samples, each in the order given, which should be
/// coherent in space. Memory: 24 bytes a point.
struct QueryPoints {
    ooc::Array<Vec3> points;
    std::uint64_t n_vertices = 0;

    [[nodiscard]] std::uint64_t size() const { return points.size(); }
};

QueryPoints make_query_points(ooc::Context& context, std::span<const LatticePoint> vertices,
                              std::span<const LatticeTriangle> triangles,
                              const AreaSampler& sampler);

}  // namespace hewer::measuring
