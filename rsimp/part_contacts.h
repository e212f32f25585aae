// SPDX-License-Identifier: MIT
/// Cells of different parts that are close to each other.
#pragma once

#include <cstdint>
#include <functional>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/cell_parts.h"

namespace hewer::rsimp {

/// Name of the part of a cell without a face.
inline constexpr std::uint32_t kNoPart = 0xfffffffeU;

/// A cell and the nearest of another part; several of a cell where several parts meet.
struct Contact {
    std::uint32_t cell;
    std::uint32_t other;
    std::uint32_t part;
    Vec3 mean;
};

/// take(contact, part of the other) one by one, by rising cell: for every cell with a face the
/// nearest cell of another part within `distance` (cells), and of further parts those that are no
/// more than twice as far. Returns the part of each cell, named by its first piece; kNoPart without
/// a face.
///
/// Only cells in boxes of the distance's size that have cells of two parts in or next to them are
/// looked at, up to kTileCells at a time with all within the distance around them
/// (rsimp/foreign_neighbours.h). Memory: 160 bytes a cell for each tile in work, 24 bytes a box.
/// Sweeps: two over the cells, one over those of such boxes. Throws OutOfMemoryBudget, also where
/// the distance holds more cells than memory has room for.
ooc::Spool<std::uint32_t> find_contacts(
    ooc::Context& context, const cluster::CellBlocks& cells, CellParts& parts, double distance,
    const std::function<void(const Contact&, std::uint32_t)>& take);
inline constexpr std::uint64_t kTileCells = 1 << 14;

}  // namespace hewer::rsimp
