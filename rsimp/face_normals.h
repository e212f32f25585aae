// SPDX-License-Identifier: MIT
/// Normals for vertices that have none of their own.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A sum of normals that has a direction.
bool is_usable_normal(const std::array<float, 3>& sum);

/// By output index: the area-weighted sum of the normals of the faces around each vertex whose own
/// is not usable. No pass over the faces if there is none such. Memory: 40 bytes for each.
std::unordered_map<std::uint32_t, std::array<float, 3>> missing_normals(
    const MeshStore& mesh, const ooc::Spool<std::array<std::uint32_t, 3>>& faces);

}  // namespace hewer::rsimp
