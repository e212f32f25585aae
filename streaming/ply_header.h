// SPDX-License-Identifier: MIT
/// The header of a PLY file: which elements follow, how many, and how their rows are built.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ooc/file.h"
#include "streaming/scalar_type.h"

namespace hewer::streaming {

enum class PlyEncoding : std::uint8_t { Ascii, LittleEndian, BigEndian };

/// One column of an element: a scalar, or a list (a count, then as many values).
struct PlyProperty {
    std::string name;
    ScalarType type = ScalarType::Float32;  ///< of the scalar, or of the list's values
    bool is_list = false;
    ScalarType count_type = ScalarType::UInt8;  ///< lists only; always an integer type
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;  ///< the header's claim; nothing is allocated or looped on its word
    std::vector<PlyProperty> properties;

    [[nodiscard]] bool has_lists() const;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Ascii;
    std::vector<PlyElement> elements;  ///< in file order
    /// NAME of each "comment TextureFile NAME", by which MeshLab and others name their textures.
    std::vector<std::string> texture_files;
    std::uint64_t n_bytes = 0;  ///< length of the header: where the data begin
    std::uint64_t n_lines = 0;

    /// Null if there is none of that name.
    [[nodiscard]] const PlyElement* find(const std::string& name) const;
};

/// Headers longer than this are refused.
constexpr std::uint64_t kMaxPlyHeaderBytes = 1 << 20;

/// Reads the header of a file that begins with "ply". Line ends LF, CRLF or CR; `comment` and
/// `obj_info` lines anywhere; the eight PLY types, their sized aliases, and the 64-bit integers
/// that some writers use. Memory: the header. Throws FormatError naming path and line.
PlyHeader read_ply_header(const ooc::InputFile& file);

}  // namespace hewer::streaming
