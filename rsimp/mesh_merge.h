// SPDX-License-Identifier: MIT
/// The finished parts of all levels as one mesh.
#pragma once

#include <vector>

#include "ooc/context.h"
#include "rsimp/block_mesh.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Adds the faces of a core and those of its vertices that are not locked (they have been added
/// before). Blocks come in the order of their ids, so that the part ends up sorted.
void append_core(MeshStore& part, BlockMesh core);

/// Parts are sorted and share no vertex and no face. One pass; memory: a buffer for each part.
MeshStore merge_parts(ooc::Context& context, std::vector<MeshStore> parts);

MeshStore make_mesh_store(ooc::Context& context, const Vec3& origin, AttributeKinds attributes);

}  // namespace hewer::rsimp
