// SPDX-License-Identifier: MIT
/// What of the original surface the fit of a level of detail sees: the mean of each cell.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// The area-weighted mean of the surface in one cell. Means, not original vertices: they are there
/// without another pass over the input, there are as many of them for each vertex of the LOD
/// whatever the size of the input, and they average the noise of a scan; docs/quality.md compares.
struct FitSample {
    std::uint64_t code;                  ///< of the cell
    std::array<std::int16_t, 3> offset;  ///< from the cell's centre, in 2^-15 cells
    std::uint16_t area_bits;             ///< the upper half of a float

    [[nodiscard]] float area() const {  ///< cell areas, above 0
        return std::bit_cast<float>(static_cast<std::uint32_t>(area_bits) << 16);
    }
    [[nodiscard]] Vec3 position() const {  ///< in cells from the lattice origin
        constexpr double kStep = 1.0 / (1 << 15);
        return cluster::center_of(code) +
               Vec3{kStep * offset[0], kStep * offset[1], kStep * offset[2]};
    }
};
static_assert(sizeof(FitSample) == 16);

/// One for each cell with a surface in it, in Morton order. One pass over the cells.
ooc::Spool<FitSample> collect_samples(ooc::Context& context, const cluster::CellBlocks& cells);

}  // namespace hewer::rsimp
