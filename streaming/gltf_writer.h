// SPDX-License-Identifier: MIT
/// glTF 2.0: GLB, or a document with its buffer in a .bin beside it.
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
///           Quantised: 16-bit integers in units of the step, which is the node's scale, from the
///           corner of the box, which is its translation (KHR_mesh_quantization). A step that 16
///           bits cannot reach leaves floats.
/// NORMAL    float, made unit length as glTF demands; one that has no direction becomes +z.
///           Quantised: three bytes.
/// COLOR_0   four normalised ushorts. glTF wants linear light where scans hold sRGB; eight bits of
///           linear light keep 183 of the 256 steps of sRGB apart, sixteen bits all of them.
///           Alpha is copied, or one. The material blends only if some alpha is below one.
/// Indices   ushort up to 65535 vertices, else uint.
///
/// The document is tinygltf's. Its container is not: tinygltf wants the whole buffer in memory and
/// copies it once more to write it. Here vertices and indices go straight to the file; in a GLB
/// behind a document of fixed size that is filled in at the end, when the exact minimum and maximum
/// of the positions are known. Memory: kFileSinkBytes + kGltfBytes.
///
/// Compressed, the mesh is held: twice its plain size for EXT_meshopt_compression,
/// DracoEncoder::bytes() for KHR_draco_mesh_compression, where positions are always quantised if
/// the error of the mesh is known.
///
/// begin() throws what require_glb_fits() or require_gltf_fits() throws, IoError as OutputFile
/// does.
std::unique_ptr<FileSink> create_gltf(const std::filesystem::path& path,
                                      const MeshFileOptions& options);

/// Throws InvalidArgument for a mesh without vertices or triangles (glTF has no empty accessor),
/// for 2^32 vertices or more (indices have 32 bits) and for coordinates that no float reaches.
void require_gltf_fits(const std::filesystem::path& path, const SinkHeader& header);

/// Also for a file above 4 GiB (GLB's lengths have 32 bits).
void require_glb_fits(const std::filesystem::path& path, const SinkHeader& header);

/// The table from sRGB to linear light, and the document while it is built.
constexpr std::uint64_t kGltfBytes = (128 << 10) + (64 << 10);

}  // namespace hewer::streaming
