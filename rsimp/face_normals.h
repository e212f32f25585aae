// SPDX-License-Identifier: MIT
/// Normals for vertices that have none of their own.
#pragma once

#include <array>
#include <cstdint>

#include "ooc/context.h"
#include "ooc/spool.h"
#include "rsimp/id_index.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// A sum of normals that has a direction.
bool is_usable_normal(const std::array<float, 3>& sum);

/// The sum of the area-weighted normals of the faces around a vertex that are in one window.
struct FaceNormal {
    std::uint64_t vertex;  ///< output index
    std::uint64_t window;
    Vec3 sum;
    bool operator<(const FaceNormal& o) const {
        return vertex != o.vertex ? vertex < o.vertex : window < o.window;
    }
};

/// Face normals at all vertices whose own is not usable, by vertex, then window. Empty, and no pass
/// over the faces, if there is none such. Precondition: mesh has attributes. Memory: an eighth of a
/// byte a vertex, a sort buffer of 2 MiB, kWindowFaceBytes a face for each window at work.
ooc::Spool<FaceNormal> missing_normals(ooc::Context& context, const MeshStore& mesh,
                                       const IdIndex& index, std::uint64_t window_faces);

}  // namespace hewer::rsimp
