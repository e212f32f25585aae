// SPDX-License-Identifier: MIT
/// Several meshes as one: the tiles of a scan.
#pragma once

#include <memory>
#include <vector>

#include "hewer/mesh_source.h"

namespace hewer::streaming {

/// The vertices and triangles of `parts` one after the other, ids shifted by the vertices before.
/// Vertices at equal places stay two: that clustering makes one of them is what closes the seams
/// between tiles. If some parts have normals or colours, vertices of the others get no normal (0 0
/// 0) and opaque white. Precondition: all parts are indexed, or all are soups; two or more.
/// @param name, format  of the whole, for SourceInfo.
std::unique_ptr<MeshSource> join_sources(std::vector<std::unique_ptr<MeshSource>> parts,
                                         std::string name, std::string format);

}  // namespace hewer::streaming
