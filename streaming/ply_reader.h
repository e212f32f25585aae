// SPDX-License-Identifier: MIT
/// The two PLY readers, behind one door each.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/ply_header.h"

namespace hewer::streaming {

/// The header's encoding decides which one fits. Throws FormatError as open_mesh() does.
std::unique_ptr<MeshSource> open_binary_ply(std::unique_ptr<ooc::InputFile> file, PlyHeader header,
                                            const OpenOptions& options);
std::unique_ptr<MeshSource> open_ascii_ply(std::unique_ptr<ooc::InputFile> file, PlyHeader header,
                                           const OpenOptions& options);

}  // namespace hewer::streaming
