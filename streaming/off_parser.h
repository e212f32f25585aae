// SPDX-License-Identifier: MIT
/// Lines of an OFF file to vertices and faces. A vertex or a face is a line.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hewer/types.h"
#include "streaming/face_import.h"
#include "streaming/off_header.h"
#include "streaming/text_chunks.h"
#include "streaming/text_colors.h"
#include "streaming/text_import.h"
#include "streaming/text_line.h"

namespace hewer::streaming {

/// Whether something else than a comment begins at `p`, the first token of a line.
inline bool is_off_content(const unsigned char* p, unsigned char line_end) {
    return *p != line_end && *p != '#';
}

/// visit(p) for the first token of each line that is not empty and no comment, until it returns
/// false.
template <typename Visit>
void for_off_lines(const TextChunk& chunk, const Visit& visit) {
    const unsigned char* p = chunk.begin();
    while (p < chunk.end()) {
        p = skip_blanks_in_line(p, chunk.line_end);
        if (is_off_content(p, chunk.line_end) && !visit(p)) return;
        p = find_line_end(p, chunk.end(), chunk.line_end) + 1;
    }
}

struct OffVertices {
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;  ///< empty, or as many
    std::vector<TextColor> colors;              ///< empty, or of the first vertices
    TextDirt dirt;
    bool has_other_numbers = false;

    void clear();
};

struct OffFaces {
    TextFaces faces;
    std::uint64_t n_lines = 0;  ///< faces, and one that is not wanted or cannot be parsed
    TextDirt dirt;
    bool has_colors = false;

    void clear();
};

/// Both throw TextProblem; what is parsed by then is in `out`.
void parse_off_vertices(const OffHeader& header, const TextChunk& chunk, OffVertices& out);
/// At most `n_wanted` faces. Ids that are no vertex become one that is none.
void parse_off_faces(const OffHeader& header, std::uint64_t n_wanted, const TextChunk& chunk,
                     OffFaces& out);

}  // namespace hewer::streaming
