// SPDX-License-Identifier: MIT
/// The two PLY readers. Textures are not looked at: see ply_textures.h.
#pragma once

#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/ply_header.h"

namespace hewer::streaming {

/// The header's encoding decides which one fits. Throws FormatError as open_mesh() does.
std::unique_ptr<MeshSource> open_binary_ply(std::shared_ptr<const ooc::InputFile> file,
                                            PlyHeader header, const OpenOptions& options);
std::unique_ptr<MeshSource> open_ascii_ply(std::shared_ptr<const ooc::InputFile> file,
                                           PlyHeader header, const OpenOptions& options);

inline std::unique_ptr<MeshSource> open_ply(std::shared_ptr<const ooc::InputFile> file,
                                            PlyHeader header, const OpenOptions& options) {
    return header.encoding == PlyEncoding::Ascii
               ? open_ascii_ply(std::move(file), std::move(header), options)
               : open_binary_ply(std::move(file), std::move(header), options);
}

}  // namespace hewer::streaming
