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
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// A cluster of which no face was left, a component that was dropped, or a cell of an unseen part.
struct LostPart {
    std::array<float, 6> box;  ///< low and high of its cells, in the frame of the mesh
    std::uint32_t n_cells;
    std::uint32_t is_unseen;  ///< 1: a cell of find_unseen_cells()
};
static_assert(sizeof(LostPart) == 32);

/// More of them, in a spool that is made with the first one.
void append_lost(ooc::Context& context, std::span<const LostPart> parts,
                 ooc::Spool<LostPart>& lost);

/// Counts a place, and lists it if it is among the largest so far. The list is in no order until
/// sort_places().
void add_place(LostPlaces& places, const LostPlace& place);
void sort_places(LostPlaces& places);

/// The cells of parts that vanish before the finishing collapse could lose them: appended one by
/// one.
///  - Parts smaller than the grid sees: cells that triangles touch but in which no surviving
///  triangle
///    has a corner, and that touch no cell that has one. (A faceless cell beside a cell with faces
///    is where a surface grazes a corner of the grid: what stands for it is a cell away at most.)
///  - Connected parts (rsimp/cell_parts.h) that share their clusters with others, so that no
///  triangle
///    of theirs is left between three clusters though no cluster is lost.
///
/// Sweeps: two over the faces and those of CellParts, one over the codes; without the second kind
/// where every cell is a cluster. Memory: a bit for each cell, CellParts and a bit for each of its
/// pieces, and for each block in flight 76 bytes a cell.
void find_unseen_cells(ooc::Context& context, const cluster::CellBlocks& cells,
                       const ClusterMesh& clusters, ooc::Spool<LostPart>& lost);

/// From the frame of the boxes to the model.
struct PlaceFrame {
    Vec3 origin;  ///< of the frame, model units
    double cell_size;
};

/// Parts whose boxes touch are one place. An unseen cell inside the box of a lost cluster is taken
/// for one of its cells. Up to kPartsAtOnce parts are compared with each other; of more, so many at
/// a time, in Morton order of their low corners, and places are not joined across: the count may
/// then be a little high. The order of the parts does not show.
///
/// Time: the boxes are swept along their longest extent. Memory: 96 bytes a part, of kPartsAtOnce
/// at most; with more a sorter.
LostPlaces find_places(ooc::Context& context, const ooc::Spool<LostPart>& parts,
                       const PlaceFrame& frame);
inline constexpr std::uint64_t kPartsAtOnce = 1 << 16;

}  // namespace hewer::rsimp
