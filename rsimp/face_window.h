// SPDX-License-Identifier: MIT
/// Windows over the faces of a mesh store.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rsimp/id_index.h"
#include "rsimp/mesh_store.h"
#include "streaming/face_window.h"

namespace hewer::rsimp {

using streaming::FaceWindow;

/// Faces [first, last) of `mesh`, by output indices. Any thread. Memory: kWindowFaceBytes a face at
/// most, with what count_window() and order_for_vertex_cache() add.
FaceWindow load_window(const MeshStore& mesh, const IdIndex& index, std::uint64_t first,
                       std::uint64_t last);
inline constexpr std::uint64_t kWindowFaceBytes = 192;

/// Positions of vertices (output indices, rising), in the frame of the mesh. Any thread.
std::vector<Vec3> read_positions(const MeshStore& mesh, std::span<const std::uint64_t> vertices);

}  // namespace hewer::rsimp
