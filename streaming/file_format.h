// SPDX-License-Identifier: MIT
/// What a file is, told by its content; and what to say of those that are no mesh.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ooc/file.h"

namespace hewer::streaming {

enum class FileFormat {
    Ply,
    BinaryStl,
    AsciiStl,
    Obj,
    Off,
    Gltf,  ///< JSON
    Glb,
    Draco,
    OpenMesh,
};

/// What has to be done before the content can be told; nothing for plain files.
enum class Packing { None, Gzip, Zstd };
Packing detect_packing(const ooc::InputFile& file);

/// The format that a user's word for it means: "ply", "stl", ... Throws InvalidArgument.
FileFormat format_named(std::string_view name, const ooc::InputFile& file);

/// The word for a format.
std::string name_of(FileFormat format);

/// The words for format_named().
std::vector<std::string> format_names();

/// By the first kilobytes of the file; its size, for binary STL; and its name only where the
/// content leaves open whether it is a damaged STL. Throws FormatError: empty, or nothing that
/// hewer reads; the message says what it seems to be.
FileFormat detect_format(const ooc::InputFile& file);

/// Whether the name of a file is that of a mesh file, compressed ones included: for folders.
bool has_mesh_extension(const std::filesystem::path& path);

}  // namespace hewer::streaming
