// SPDX-License-Identifier: MIT
/// glTF 2.0 and GLB.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "hewer/report.h"
#include "ooc/file.h"

namespace hewer::streaming {

/// The triangles of all meshes that the nodes of the default scene place (all root nodes, if there
/// is no scene; all meshes, if there are no nodes), each as often as it is placed, in the
/// coordinates of the scene. Triangles, strips and fans; what is not carried is named in
/// SourceInfo::ignored. Colours are those of the vertices times the base colour of the material and
/// its texture (GltfTextures); a base colour that is the same for all of the scene makes none.
///
/// Buffers are read where they lie; those of EXT_meshopt_compression and KHR_draco_mesh_compression
/// are decoded to temporary files. Memory: the document while it is opened, a compressed piece at a
/// time, textures while they are sampled, and some 500 bytes for each placed primitive.
/// Throws: FormatError, IoError, OutOfMemoryBudget, OutOfDiskBudget.
std::unique_ptr<MeshSource> open_gltf(std::unique_ptr<ooc::InputFile> file, bool is_binary,
                                      const OpenOptions& options, const Hooks& hooks);

/// What the document says of that: format, bytes of all files, counts, attributes, and the box that
/// the accessors claim (around the turned boxes of what is placed), if all of them do. Nothing but
/// the JSON is read. Returns whether some of it has to be decoded before it can be read.
/// Throws as open_gltf().
bool glance_gltf(std::unique_ptr<ooc::InputFile> file, bool is_binary, const OpenOptions& options,
                 InputReport& report);

}  // namespace hewer::streaming
