// SPDX-License-Identifier: MIT
/// A glTF document with its buffers where they lie: nothing of their content is in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/file_range.h"
#include "streaming/gltf_model.h"

namespace hewer::streaming {

struct GltfDocument {
    std::string name;  ///< the path, for messages
    gltf::Model model;
    /// No file: a stand-in for compressed data (the fallback of EXT_meshopt_compression).
    std::vector<FileRange> buffers;
    std::uint64_t n_bytes = 0;          ///< of all files together
    std::uint64_t held_temp_bytes = 0;  ///< of buffers that were unpacked
    bool is_binary = false;             ///< GLB
    std::uint64_t trailing_bytes = 0;   ///< behind the end that its header tells
};

/// Reads the document of a .gltf or .glb file. Buffers in other files are looked for beside it, by
/// relative names only; those inside the JSON (data:) go to a temporary file.
/// Memory: some 24 bytes for each byte of the JSON, while it is parsed; less afterwards.
/// Throws: FormatError (path, what and where), IoError (a buffer's file is missing),
/// OutOfMemoryBudget, OutOfDiskBudget.
GltfDocument read_gltf(std::unique_ptr<ooc::InputFile> file, bool is_binary,
                       const OpenOptions& options);

/// The file of image `index`, wherever it is: a file of its own (of which the size is added to
/// n_bytes), part of a buffer, or in the JSON. Throws FormatError, IoError, OutOfDiskBudget.
FileRange open_image_data(GltfDocument& document, std::int64_t index, const OpenOptions& options);

/// The bytes of buffer view `index`. Throws FormatError if it is none, or reaches out of its
/// buffer.
FileRange buffer_view(const GltfDocument& document, std::int64_t index);

}  // namespace hewer::streaming
