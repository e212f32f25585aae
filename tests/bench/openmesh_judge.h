// SPDX-License-Identifier: MIT
/// OpenMesh's opinion of a mesh: a half-edge structure cannot hold what is not manifold, so it
/// refuses such faces when it builds one.
#pragma once

#include <cstdint>

#include "tests/bench/plain_ply.h"

namespace bench {

struct OpenMeshVerdict {
    std::uint64_t refused_faces = 0;
    std::uint64_t border_edges = 0;          ///< of the faces that it took
    std::uint64_t nonmanifold_vertices = 0;  ///< where several open fans meet
};

/// Adds the faces in their order; which of several that clash is refused depends on it.
OpenMeshVerdict judge_with_openmesh(const PlainMesh& mesh);

}  // namespace bench
