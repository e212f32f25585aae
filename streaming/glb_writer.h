// SPDX-License-Identifier: MIT
/// Binary glTF 2.0 (GLB).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "streaming/file_sink.h"

namespace hewer::streaming {

/// One node, one mesh, one primitive, an interleaved vertex buffer and an index buffer.
///
/// POSITION  float. Where float_is_too_coarse() they are relative to local_origin(), which becomes
///           the node's translation; a viewer that adds the two in double loses nothing.
/// NORMAL    float, made unit length as glTF demands; one that has no direction becomes +z.
/// COLOR_0   four normalised ushorts. glTF wants linear light where scans hold sRGB; eight bits of
///           linear light keep 183 of the 256 steps of sRGB apart, sixteen bits all of them.
///           Alpha is copied, or one. The material blends only if some alpha is below one.
/// Indices   ushort up to 65535 vertices, else uint.
///
/// The document is tinygltf's. Its container is not: tinygltf wants the whole buffer in memory and
/// copies it once more to write it. Here vertices and indices go straight to the file, behind a
/// document of fixed size that is filled in at the end, when the exact minimum and maximum of the
/// positions are known. Memory: kFileSinkBytes + kGlbBytes.
///
/// begin() throws what require_glb_fits() throws, IoError as OutputFile does.
std::unique_ptr<FileSink> create_glb(const std::filesystem::path& path, bool overwrite);

/// Throws InvalidArgument for a file above 4 GiB (GLB's lengths have 32 bits), for a mesh without
/// vertices or triangles (glTF has no empty accessor) and for coordinates that no float reaches.
void require_glb_fits(const std::filesystem::path& path, const SinkHeader& header);

/// The table from sRGB to linear light, and the document while it is built.
constexpr std::uint64_t kGlbBytes = (128 << 10) + (64 << 10);

}  // namespace hewer::streaming
