// SPDX-License-Identifier: MIT
/// The finished parts of all levels as one mesh.
#pragma once

#include <vector>

#include "ooc/context.h"
#include "rsimp/block_mesh.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// What a block adds to its part: its faces, sorted, and its vertices but for the locked ones,
/// which have been added before.
struct SortedCore {
    std::vector<StoredVertex> vertices;
    VertexAttributes attributes;
    std::vector<Face> faces;
};
SortedCore sort_core(BlockMesh core);

/// Blocks come in the order of their ids, so that the part ends up sorted.
void append_core(MeshStore& part, const SortedCore& core);

/// Parts are sorted and share no vertex and no face. One pass, by runs: what a part adds to another
/// is in few places. Memory: a buffer for each part.
MeshStore merge_parts(ooc::Context& context, std::vector<MeshStore> parts);

MeshStore make_mesh_store(ooc::Context& context, const Vec3& origin, AttributeKinds attributes);

}  // namespace hewer::rsimp
