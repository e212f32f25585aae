// SPDX-License-Identifier: MIT
/// Binary STL: 80 bytes of anything, a 32-bit count, then 50 bytes a triangle.
#pragma once

#include <cstdint>
#include <memory>

#include "hewer/mesh_source.h"
#include "ooc/file.h"

namespace hewer::streaming {

constexpr std::uint64_t kStlHeaderBytes = 84;
constexpr std::uint64_t kStlTriangleBytes = 50;

/// Whether the size is what the count says: the only reliable mark of a binary STL file, since many
/// begin with "solid" like the text variant.
bool is_whole_binary_stl(const ooc::InputFile& file);

/// The box of triangles in pieces at equal distances.
Bounds sample_stl_box(const ooc::InputFile& file);

/// A triangle soup. Stored normals and attribute bytes are not carried. A count that is wrong while
/// the size fits a whole number of triangles is replaced by that number and noted in
/// SourceInfo::ignored (some writers leave it 0, and beyond 2^32 triangles it cannot be right).
/// Throws FormatError: truncated, or no triangles.
std::unique_ptr<MeshSource> open_binary_stl(std::unique_ptr<ooc::InputFile> file, bool is_strict);

}  // namespace hewer::streaming
