// SPDX-License-Identifier: MIT
/// A run of consecutive faces of a mesh, small enough to work on in a core's cache.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rsimp/id_index.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Faces by places in a list of their vertices. The list rises, so places compare as the vertices
/// do.
struct FaceWindow {
    std::vector<std::uint64_t> vertices;              ///< output indices, rising, each once
    std::vector<std::array<std::uint32_t, 3>> faces;  ///< in the order of the mesh
    /// Smallest vertex of the face after the window, or the number of vertices: no later face has a
    /// vertex below it.
    std::uint64_t next = 0;
};

/// Faces [first, last) of `mesh`. Any thread. Memory: kWindowFaceBytes a face at most, with what
/// count_window() and order_for_vertex_cache() add.
FaceWindow load_window(const MeshStore& mesh, const IdIndex& index, std::uint64_t first,
                       std::uint64_t last);
inline constexpr std::uint64_t kWindowFaceBytes = 192;

/// Positions of vertices (output indices, rising), in the frame of the mesh. Any thread.
std::vector<Vec3> read_positions(const MeshStore& mesh, std::span<const std::uint64_t> vertices);

}  // namespace hewer::rsimp
