// SPDX-License-Identifier: MIT
/// The beginning of an OFF file.
#pragma once

#include <cstdint>
#include <string>

#include "ooc/file.h"

namespace hewer::streaming {

/// What stands in front of the vertices. The counts are the file's own claim.
struct OffHeader {
    std::string name;  ///< "COFF"
    bool has_normals = false;
    bool has_colors = false;
    bool has_texture = false;
    bool has_colors_first = false;  ///< in front of the normals
    std::uint64_t n_vertices = 0;
    std::uint64_t n_faces = 0;
    std::uint64_t n_bytes = 0;  ///< up to the line after the counts
    std::uint64_t n_lines = 0;  ///< in these
};

/// Throws FormatError with path and line: no OFF, binary OFF, more than three dimensions, counts
/// that are none.
OffHeader read_off_header(const ooc::InputFile& file);

}  // namespace hewer::streaming
