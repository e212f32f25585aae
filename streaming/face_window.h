// SPDX-License-Identifier: MIT
/// A run of faces, small enough to work on in a core's cache.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hewer::streaming {

/// Faces by places in a list of their vertices. The list rises, so places compare as the vertices
/// do.
struct FaceWindow {
    std::vector<std::uint64_t> vertices;              ///< indices, rising, each once
    std::vector<std::array<std::uint32_t, 3>> faces;  ///< in the order of the mesh
    /// No later face has a vertex below it. The number of vertices at the end of a mesh.
    std::uint64_t next = 0;
};

}  // namespace hewer::streaming
