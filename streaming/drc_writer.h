// SPDX-License-Identifier: MIT
/// Draco files.
#pragma once

#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// Positions quantised as asked, automatically if nothing is asked and the error of the mesh is
/// known, else exact floats; normals with 10 bits, colours with 16. Coordinates are plain floats:
/// Draco has no offset. Holds the mesh: DracoEncoder::bytes().
/// begin() throws what require_drc_fits() throws, IoError as OutputFile does.
std::unique_ptr<FileSink> create_drc(const std::filesystem::path& path,
                                     const MeshFileOptions& options);

/// Throws InvalidArgument for a mesh without triangles, beyond 2^31 of anything, or with
/// coordinates that no float reaches.
void require_drc_fits(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
