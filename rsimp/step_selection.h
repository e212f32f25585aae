// SPDX-License-Identifier: MIT
/// The exact cut through many logs of collapses.
#pragma once

#include <cstdint>
#include <vector>

#include "rsimp/step_store.h"

namespace hewer::rsimp {

/// How many steps of each log to carry out so that at least `n_faces` faces vanish, cheapest steps
/// of all logs first, and no step more; with `n_vertices` (and n_faces 0) the same for vertices. At
/// equal keys the earlier logs go first. Everything, if that is not enough. Two passes over the
/// logs; memory: two histograms of 2^16 counts.
std::vector<std::uint64_t> select_steps(const StepStore& logs, std::uint64_t n_faces,
                                        std::uint64_t n_vertices);

}  // namespace hewer::rsimp
