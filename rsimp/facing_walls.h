// SPDX-License-Identifier: MIT
/// Walls of two parts that joining has laid onto each other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cluster/cell_record.h"
#include "hewer/types.h"

namespace hewer::rsimp {

/// A triangle between merged cells, and where its corners are.
struct WallFace {
    cluster::CellTriple cells;
    std::array<Vec3, 3> corners;
};

/// Which of the faces to keep. Two walls on the same cells enclose nothing, but where they are cut
/// into triangles in different ways these do not cancel one by one: they would stay as flat
/// bubbles, and cost triangles. A patch of faces (connected by cells) goes if every edge is there
/// as often one way as the other, so that nothing opens, and if the volume inside is less than a
/// tenth of what it would be with its sides `distance` apart. Time: O(n log n).
std::vector<bool> kept_walls(std::span<const WallFace> faces, double distance);

}  // namespace hewer::rsimp
