// SPDX-License-Identifier: MIT
/// Repairs a level of detail where it is too far from its original.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hewer/mesh_source.h"
#include "hewer/types.h"

namespace hewer::fidelity {

/// A point of the original, and one of the mesh that should be there, or near it.
struct Pull {
    Vec3 from{};
    Vec3 to{};
    double near = 0;  ///< this far from each other is near enough
    /// What is tried first.
    enum class By {
        Distance,  ///< corners if it is nearly near enough, else a vertex
        Vertex,
        Flip,
        Corners,  ///< and nothing else
    };
    By by = By::Distance;
};

struct PullReport {
    std::uint64_t n_done = 0;  ///< of the pulls
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    std::uint64_t border_edges = 0;  ///< more than before, as the two above
    /// Those that pulls began at, and all that are changed or new; ascending.
    std::vector<std::uint64_t> faces;
    /// Of the faces that a pull has changed, before and after; one for each that was done.
    std::vector<Bounds> boxes;
};

/// For each pull the face nearest to `from` is changed. If its nearest point is no farther than 1.4
/// times what is near enough, its corners move as little as takes it there. Else it gets a vertex
/// at `to`: inside it (three faces instead of one) or on an edge that is near (two instead of each
/// there), whichever turns faces less. What cannot be done in one way is tried in the other. No
/// face turns by more than 84 degrees. Components, borders and handles stay as they are; new
/// vertices have the attributes of where they come from.
///
/// Pulls come in the order of their weight. A face that one has changed is not changed by another:
/// there may be more to do in a second call. Time: every 64 faces are looked at with each pull, one
/// thread. Memory: a bit a vertex and face, and some kilobytes a pull.
PullReport pull_to_points(Mesh& mesh, std::span<const Pull> pulls);

}  // namespace hewer::fidelity
