// SPDX-License-Identifier: MIT
/// Textures of PLY files, as MeshLab and photogrammetry write them, as colours of the vertices.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"

namespace hewer::streaming {

/// A PLY file. If its header names textures ("comment TextureFile NAME"), and vertices or corners
/// of faces have texture coordinates, the vertices get the colours of these (see docs/textures.md);
/// where a texture gives none, those that they have.
///
/// Temporary disk: 8 bytes a vertex, held by the source; while it is opened 15 bytes a triangle and
/// 24 for the coordinates of its corners, or 8 a vertex; of ASCII 24 a vertex; and those of
/// TextureSet. Memory: as TextureSet and paint_vertices(). Throws: as open_mesh().
std::unique_ptr<MeshSource> open_textured_ply(std::unique_ptr<ooc::InputFile> file,
                                              const OpenOptions& options, const Hooks& hooks);

}  // namespace hewer::streaming
