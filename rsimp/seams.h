// SPDX-License-Identifier: MIT
/// The faces between the blocks of one level.
#pragma once

#include <cstdint>
#include <vector>

#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/box_groups.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Settles the duplicates among faces between blocks: all copies of a face are there.
ooc::Spool<Face> settle_crossing(ooc::Context& context, ooc::Spool<Face> faces, bool is_closed);

/// Faces that ran between the smaller blocks of the level before, told apart by the blocks of this
/// one.
class Seams {
  public:
    /// Takes the faces out of `faces`. One pass over them; memory: two sort buffers.
    Seams(ooc::Context& context, ooc::Spool<Face> faces, const IdRanges& blocks);

    /// Faces all of whose corners are in the block now.
    [[nodiscard]] std::vector<Face> inside(std::size_t block) const;
    /// Ids of the vertices in the block that have a face reaching out of it; rising.
    [[nodiscard]] std::vector<VertexId> frozen(std::size_t block) const;
    [[nodiscard]] std::uint64_t n_frozen() const { return frozen_.size(); }
    /// Those that still run between blocks.
    [[nodiscard]] const ooc::Spool<Face>& crossing() const { return crossing_; }
    ooc::Spool<Face> take_crossing() { return std::move(crossing_); }

  private:
    ooc::Spool<Face> inside_;                  // sorted
    ooc::Spool<VertexId> frozen_;              // sorted, each once
    ooc::Spool<Face> crossing_;                // in no particular order
    std::vector<std::uint64_t> first_inside_;  // of each block, and the end
    std::vector<std::uint64_t> first_frozen_;
};

}  // namespace hewer::rsimp
