// SPDX-License-Identifier: MIT
/// What of the original surface the fit of a level of detail sees.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// The mean of the surface in one cell, or the centre of a triangle between the means of three;
/// with the area that it stands for and the direction that it faces. Not original vertices: cells
/// are there without another pass over the input, there are some seven for each vertex of the LOD
/// whatever the size of the input, and they average the noise of a scan; docs/fit.md compares.
struct FitSample {
    std::array<std::uint32_t, 3> place;  ///< from the lattice origin, in 2^-kPlaceBits cells
    std::uint16_t area_bits;             ///< the upper half of a float
    std::array<std::int8_t, 2> front;    ///< the unit normal on an octahedron, unfolded

    static constexpr unsigned kPlaceBits = 12;

    FitSample() = default;
    FitSample(const Vec3& position, const Vec3& normal, double area);

    [[nodiscard]] Vec3 position() const {  ///< in cells from the lattice origin
        constexpr double kStep = 1.0 / (1U << kPlaceBits);
        return {kStep * place[0], kStep * place[1], kStep * place[2]};
    }
    [[nodiscard]] float area() const {  ///< cell areas, above 0
        return std::bit_cast<float>(static_cast<std::uint32_t>(area_bits) << 16);
    }
    [[nodiscard]] Vec3 normal() const;  ///< about a unit long, right to a degree
};
static_assert(sizeof(FitSample) == 16);

/// One for each cell that a triangle has a corner in: parts smaller than that would pull at what is
/// near, and have no front. By block of cells, in Morton order. Where cells are few, `with_centers`
/// adds one for each triangle; where cells hold many vertices, these would lie too low in every
/// bend. One pass over cells and triangles. Memory: a block of cells and its triangles for each
/// thread.
ooc::Spool<FitSample> collect_samples(ooc::Context& context, const cluster::CellBlocks& cells,
                                      bool of_triangles);

}  // namespace hewer::rsimp
