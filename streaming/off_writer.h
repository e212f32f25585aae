// SPDX-License-Identifier: MIT
/// Geomview OFF, text.
#pragma once

#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// "OFF", "NOFF" with normals, "COFF" with colours, "CNOFF" with both ("x y z nx ny nz r g b a",
/// colours 0..255 with alpha: what the readers of the format agree on). Coordinates with the fewest
/// digits that read back as the same float, or double by needs_double(). Streams: memory
/// kFileSinkBytes. No limit on counts. Throws IoError as OutputFile does.
std::unique_ptr<FileSink> create_off(const std::filesystem::path& path,
                                     const MeshFileOptions& options);

}  // namespace hewer::streaming
