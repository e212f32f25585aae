// SPDX-License-Identifier: MIT
/// Parts of the surface of which no triangle is left: where they were, and how large.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "cluster/cell_blocks.h"
#include "hewer/report.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::rsimp {

/// A cluster of which no face was left, a component that was dropped, or a lone cell.
struct LostPart {
    std::array<float, 6> box;  ///< low and high of its cells, in the frame of the mesh
    std::uint32_t n_cells;
    std::uint32_t is_lone;  ///< 1: a cell that never had a face
};
static_assert(sizeof(LostPart) == 32);

/// More of them, in a spool that is made with the first one.
void append_lost(ooc::Context& context, std::span<const LostPart> parts,
                 ooc::Spool<LostPart>& lost);

/// Counts a place, and lists it if it is among the largest so far.
void add_place(LostPlaces& places, const LostPlace& place);

/// The parts that are smaller than the grid sees: cells that triangles touch but in which no
/// surviving triangle has a corner, and that touch no cell that has one. A faceless cell beside a
/// cell with faces is where a surface grazes a corner of the grid: what stands for it is a cell
/// away at most, and it is not counted. `origin` is that of the frame for the boxes.
///
/// Two sweeps: over the faces, then over the codes. Memory: a bit for each cell, and for each block
/// in flight 8 bytes a cell.
void find_lone_cells(ooc::Context& context, const cluster::CellBlocks& cells, const Vec3& origin,
                     ooc::Spool<LostPart>& lost);

/// From the frame of the boxes to the model.
struct PlaceFrame {
    Vec3 origin;  ///< of the frame, model units
    double cell_size;
};

/// Parts whose boxes touch are one place. A lone cell inside the box of a lost cluster is taken for
/// one of its cells. Up to kPartsAtOnce parts are compared with each other; of more, so many at a
/// time, in Morton order of their low corners, and places are not joined across: the count may then
/// be a little high. The order of the parts does not show.
///
/// Time: the boxes are swept along their longest extent. Memory: 96 bytes a part, of kPartsAtOnce
/// at most; with more a sorter.
LostPlaces find_places(ooc::Context& context, const ooc::Spool<LostPart>& parts,
                       const PlaceFrame& frame);
inline constexpr std::uint64_t kPartsAtOnce = 1 << 16;

}  // namespace hewer::rsimp
