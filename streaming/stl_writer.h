// SPDX-License-Identifier: MIT
/// Binary STL.
#pragma once

#include <filesystem>
#include <memory>

#include "hewer/mesh_sink.h"

namespace hewer::streaming {

/// What the writer holds for each vertex of the mesh: STL repeats positions in every facet.
constexpr std::uint64_t kStlVertexBytes = 12;

/// 80 bytes of text, the count, 50 bytes a facet: geometric normal (zero for a facet without area)
/// and three corners. STL has floats only, no offset, no colours and no vertex normals: colours and
/// normals are left out, and coordinates far from the origin lose what a float cannot hold.
/// Memory: kFileSinkBytes + kStlVertexBytes * n_vertices, taken in begin().
/// begin() throws InvalidArgument for more than 2^32 - 1 triangles or coordinates beyond float.
/// Throws IoError as OutputFile does.
std::unique_ptr<MeshSink> create_stl(const std::filesystem::path& path, bool overwrite);

}  // namespace hewer::streaming
