// SPDX-License-Identifier: MIT
/// A piece of the mesh in memory: what one thread works on during the finishing collapse.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "rsimp/mesh_store.h"
#include "rsimp/vertex_attributes.h"

namespace hewer::rsimp {

inline constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

/// Corners are places in BlockMesh::vertices.
using LocalFace = std::array<std::uint32_t, 3>;

/// StoredVertex::flags. A vertex without any of them is free: all of its faces are in the block,
/// they form one fan, and it may move.
struct VertexFlags {
    /// Still stands for a whole cluster: its faces may form several fans.
    static constexpr std::uint32_t kRaw = 1;
    /// Has faces that reach into another block: must stay as it is, for now.
    static constexpr std::uint32_t kFrozen = 2;
    /// Its other faces are finished: it must stay as it is, for good, and is already written.
    static constexpr std::uint32_t kLocked = 4;
    /// Has been free before: the collapse has had its chance with it.
    static constexpr std::uint32_t kProcessed = 8;

    static constexpr bool has_faces_elsewhere(std::uint32_t flags) {
        return (flags & (kFrozen | kLocked)) != 0;
    }
    static constexpr bool is_free(std::uint32_t flags) {
        return (flags & (kRaw | kFrozen | kLocked)) == 0;
    }
};

struct BlockMesh {
    std::vector<StoredVertex> vertices;  ///< rising ids
    VertexAttributes attributes;
    std::vector<LocalFace> faces;

    [[nodiscard]] bool is_free(std::uint32_t v) const {
        return VertexFlags::is_free(vertices[v].flags);
    }
    [[nodiscard]] const Vec3& position(std::uint32_t v) const {
        return vertices[v].vertex.position;
    }
};

inline bool is_degenerate(const LocalFace& t) {
    return t[0] == t[1] || t[1] == t[2] || t[0] == t[2];
}

/// Place of the vertex with this id, which must be there.
std::uint32_t find_vertex(const BlockMesh& mesh, VertexId id);

inline LocalFace local_face(const BlockMesh& mesh, const Face& face) {
    return {find_vertex(mesh, face[0]), find_vertex(mesh, face[1]), find_vertex(mesh, face[2])};
}

/// The face by ids, smallest first.
Face global_face(const BlockMesh& mesh, const LocalFace& face);

/// Keeps the vertices with a mark, in their order; faces must not use the others.
void keep_vertices(BlockMesh& mesh, const std::vector<bool>& is_kept);

/// Brings the vertices back into the order of their ids.
void sort_vertices(BlockMesh& mesh);

}  // namespace hewer::rsimp
