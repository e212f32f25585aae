// SPDX-License-Identifier: MIT
/// The collapses of one level: all blocks down to one common cost.
#pragma once

#include <cstdint>
#include <vector>

#include "ooc/context.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/piece_store.h"
#include "rsimp/step_store.h"

namespace hewer::rsimp {

/// What has to go on a level.
struct CollapseNeed {
    std::uint64_t faces = 0;     ///< at least so many, or
    std::uint64_t vertices = 0;  ///< so many, or
    CollapseRules rules;         ///< with a most displacement, whatever can go

    [[nodiscard]] bool is_none() const {
        return faces == 0 && vertices == 0 && !rules.most_displacement;
    }
};

struct CollapseLogs {
    StepStore logs;                      ///< one for each block
    std::vector<std::uint64_t> n_steps;  ///< of each log, to be carried out
};

/// Collapses are recorded, not carried out: each block by itself, a little further than needed;
/// then the cheapest of all are chosen exactly. How far, is estimated from a few of the blocks
/// first; if it was not far enough, the blocks are run again, farther. So no block waits for
/// another, and the result depends on nothing but the blocks.
///
/// `n_open`: vertices of each block that have not been through a collapse before; what has to go is
/// expected to be spread evenly over them. Memory: for each block at work its mesh and
/// EdgeCollapse::bytes_for().
CollapseLogs collapse_blocks(ooc::Context& context, const PieceStore& blocks,
                             const std::vector<std::uint64_t>& n_open, const CollapseNeed& need);

/// How many blocks may be at work at once, by the budget; not more than there are threads.
std::size_t most_blocks_alive(ooc::Context& context, std::uint64_t bytes_a_block);

}  // namespace hewer::rsimp
