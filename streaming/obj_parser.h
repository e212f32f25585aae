// SPDX-License-Identifier: MIT
/// Lines of an OBJ file to what they say, without knowing what stands before them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hewer/types.h"
#include "streaming/face_import.h"
#include "streaming/text_chunks.h"
#include "streaming/text_colors.h"
#include "streaming/text_import.h"

namespace hewer::streaming {

/// Ids in a chunk. Those of the file count from 0 here. Relative ones ("-1": the vertex before)
/// are kRelative + their distance from the first vertex of the chunk, which may be negative.
struct ObjId {
    static constexpr std::uint64_t kNone = std::uint64_t{1} << 61;  ///< the file says 0
    static constexpr std::uint64_t kRelative = std::uint64_t{1} << 62;

    /// The id in the file; one that is no vertex where there is none.
    static std::uint64_t resolve(std::uint64_t id, std::uint64_t n_vertices_before) {
        if (id <= kNone) return id;
        const std::uint64_t resolved = n_vertices_before + (id - kRelative);
        return resolved < kNone ? resolved : kNone;
    }
};

/// What a chunk holds. Numbers of elements and lines count from the beginning of the chunk.
struct ObjChunk {
    std::vector<Vec3> positions;
    std::vector<TextColor> colors;  ///< empty, or of the first vertices
    std::vector<std::array<float, 3>> normals;
    std::vector<std::array<float, 2>> texcoords;
    TextFaces faces;               ///< ids as in ObjId
    TextDirt dirt;                 ///< out of range: not known here
    std::uint64_t highest_id = 0;  ///< of those that are not relative
    bool has_relative_ids = false;

    // How the corners refer to normals.
    bool has_corners_without_normal = false;
    bool has_corners_with_normal = false;
    bool has_other_normals = false;  ///< not of the number of the vertex
    /// Relative ones: of the normal minus that of the vertex, both from the beginning of the chunk.
    std::optional<std::int64_t> relative_normal_shift;

    /// What stands behind "usemtl" or "mtllib", before triangle `n_before` of the chunk.
    struct MaterialLine {
        std::size_t n_before;
        std::string text;
    };
    std::vector<MaterialLine> used_materials;
    std::vector<MaterialLine> material_files;

    std::vector<std::string> ignored;  ///< for MeshImport::ignore()
    std::string first_unknown;         ///< of the words that begin no statement of OBJ, in quotes

    void clear();
};

/// Parses the lines of `chunk`, joining those that a backslash continues (which changes its bytes).
/// Throws TextProblem: what is parsed by then is in `out`.
void parse_obj(TextChunk& chunk, ObjChunk& out);

/// The first face of `chunk` with a corner that is no vertex of the `n_vertices` of the file; of
/// these, `n_vertices_before` stand in front of the chunk.
std::optional<TextPlace> find_out_of_range(TextChunk& chunk, std::uint64_t n_vertices,
                                           std::uint64_t n_vertices_before);

}  // namespace hewer::streaming
