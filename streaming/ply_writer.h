// SPDX-License-Identifier: MIT
/// Binary little-endian PLY.
#pragma once

#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// Vertices: x y z as float, or as double by needs_double(); nx ny nz as float; red green blue
/// [alpha] as uchar, the nearest of 256 steps. Faces: `list uchar int vertex_indices`, `list uchar
/// uint` where ids reach 2^31. Streams: memory kFileSinkBytes.
/// begin() throws what require_ply_fits() throws, IoError as OutputFile does.
std::unique_ptr<FileSink> create_ply(const std::filesystem::path& path,
                                     const MeshFileOptions& options);

/// Throws InvalidArgument for more than 2^32 vertices: PLY has no larger integer.
void require_ply_fits(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
