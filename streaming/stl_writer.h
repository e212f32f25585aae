// SPDX-License-Identifier: MIT
/// Binary STL.
#pragma once

#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// 80 bytes of text, the count, 50 bytes a facet: geometric normal (zero for a facet without area)
/// and three corners. STL has floats only, no offset, no colours and no vertex normals: colours and
/// normals are left out, and coordinates far from the origin lose what a float cannot hold.
/// Memory: kFileSinkBytes; 12 bytes a vertex more if the mesh comes as vertices and triangles
/// instead of points. begin() throws what require_stl_fits() throws, IoError as OutputFile does.
std::unique_ptr<FileSink> create_stl(const std::filesystem::path& path,
                                     const MeshFileOptions& options);

/// Throws InvalidArgument for more than 2^32 - 1 triangles or coordinates beyond float.
void require_stl_fits(const std::filesystem::path& path, const SinkHeader& header);

}  // namespace hewer::streaming
