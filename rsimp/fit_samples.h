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

/// Which places of the surface the fit looks at.
struct SampleChoice {
    /// The triangles between cells instead of the cells: where cells are few. Where they hold many
    /// vertices, centres of triangles would lie too low in every bend.
    bool of_all_triangles = false;
    /// Triangles larger than this, in cell areas, are cut into parts with a sample for each, up to
    /// 256 of them: between the corners of a triangle that is larger than those of the LOD nothing
    /// else says where the surface is.
    double largest_area = 0;
};

/// One for each cell that a triangle has a corner in (parts smaller than that would pull at what is
/// near, and have no front), or for each triangle, and more for large triangles. By block of cells,
/// in Morton order. One pass over cells and triangles. Memory: a block of cells and its triangles
/// for each thread.
ooc::Spool<FitSample> collect_samples(ooc::Context& context, const cluster::CellBlocks& cells,
                                      const SampleChoice& choice);

}  // namespace hewer::rsimp
