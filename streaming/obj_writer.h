// SPDX-License-Identifier: MIT
/// Wavefront OBJ, text.
#pragma once

#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// `v x y z` with the fewest digits that read back as the same float, or the same double by
/// needs_double(); colours behind the position, `v x y z r g b`, 0..1, the way that MeshLab and
/// Blender read (five digits, which tell all 65536 steps apart; alpha has no place in it); `vn` and
/// `f a//a` with normals. Streams: memory kFileSinkBytes. No limit on counts.
/// Throws IoError as OutputFile does.
std::unique_ptr<FileSink> create_obj(const std::filesystem::path& path,
                                     const MeshFileOptions& options);

}  // namespace hewer::streaming
