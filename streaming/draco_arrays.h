// SPDX-License-Identifier: MIT
/// Draco-compressed meshes: files, and primitives of glTF.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/array_source.h"

namespace hewer::streaming {

/// Attributes by their unique ids in the Draco data; where there are none, by their meaning.
struct DracoIds {
    std::optional<std::uint32_t> positions;
    std::optional<std::uint32_t> normals;
    std::optional<std::uint32_t> colors;
    std::optional<std::uint32_t> texcoords;  // texcoords and weights by their ids alone
    std::optional<std::uint32_t> weights;
};

/// Decodes `n_bytes` at `offset` of the file to arrays in a temporary file; the names and all but
/// the arrays of the result are the caller's. The decoder of the library holds all of the mesh at
/// once. Its size is taken from the counts in the header, which are not trusted: what they ask for
/// is checked against the limit first.
/// Memory: `n_bytes`, and 200 bytes a face, until it returns.
/// Throws: FormatError (damaged; a point cloud), OutOfMemoryBudget (with the number that would do),
/// OutOfDiskBudget, IoError.
ArrayMesh decode_draco(const ooc::InputFile& file, std::uint64_t offset, std::uint64_t n_bytes,
                       const DracoIds& ids, const OpenOptions& options);

/// A .drc file. Colours are what the file says, taken for sRGB as in PLY.
std::unique_ptr<MeshSource> open_draco(std::unique_ptr<ooc::InputFile> file,
                                       const OpenOptions& options);

}  // namespace hewer::streaming
