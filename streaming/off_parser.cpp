// SPDX-License-Identifier: MIT
#include "streaming/off_parser.h"

#include <algorithm>
#include <span>

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kNoVertex = ~std::uint64_t{0};

/// What stands behind a position, in a line of vertices.
struct Tail {
    static constexpr std::size_t kMost = 12;
    std::array<double, kMost> numbers{};
    std::size_t n = 0;
};

/// Normal, colour, texture coordinates. With fewer numbers than that, the colour is missing.
void split(const Tail& tail, const OffHeader& header, OffVertices& out) {
    std::size_t n = tail.n;
    if (header.has_texture) n -= 2;
    const double* color = tail.numbers.data();
    if (header.has_normals) {
        n -= 3;
        out.normals.push_back(to_normal(header.has_colors_first ? color + n : color));
        if (!header.has_colors_first) color += 3;
    }
    if (header.has_colors && (n == 3 || n == 4)) {
        out.colors.resize(out.positions.size() - 1, kNoTextColor);
        out.colors.push_back(make_text_color({color, n}));
    } else if (n > 0) {
        out.has_other_numbers = true;
    }
}

}  // namespace

void OffVertices::clear() {
    positions.clear();
    normals.clear();
    colors.clear();
    dirt = {};
    has_other_numbers = false;
}

void OffFaces::clear() {
    faces.clear();
    n_lines = 0;
    dirt = {};
    has_colors = false;
}

void parse_off_vertices(const OffHeader& header, const TextChunk& chunk, OffVertices& out) {
    out.clear();
    const std::size_t n_least =
        std::size_t{header.has_normals ? 3U : 0U} + std::size_t{header.has_texture ? 2U : 0U};
    for_off_lines(chunk, [&](const unsigned char* line) {
        Vec3 position;
        bool is_finite = true;
        const unsigned char* p = read_position(line, chunk, position, is_finite);
        if (!is_finite && !out.dirt.nonfinite) {
            out.dirt.nonfinite = TextPlace{out.positions.size(), chunk.lines_before(line)};
        }
        out.positions.push_back(position);
        Tail tail;
        for (;;) {
            p = skip_blanks_in_line(p, chunk.line_end);
            const bool is_end = !is_off_content(p, chunk.line_end) || tail.n == Tail::kMost;
            if (is_end && tail.n >= n_least) break;
            p = read_double(p, chunk, tail.numbers[tail.n++]);
        }
        if (tail.n > 0) split(tail, header, out);
        return true;
    });
}

void parse_off_faces(const OffHeader& header, std::uint64_t n_wanted, const TextChunk& chunk,
                     OffFaces& out) {
    out.clear();
    for_off_lines(chunk, [&](const unsigned char* line) {
        ++out.n_lines;
        if (out.faces.n_faces == n_wanted) return false;
        std::int64_t n_corners = 0;
        const unsigned char* p = parse_integer(line, n_corners);
        if (p == nullptr || n_corners < 0) {
            refuse_number(line, chunk, "the number of corners of a face");
        }
        TextFace face(out.faces);
        bool is_in_range = true;
        for (; n_corners > 0; --n_corners) {
            p = skip_blanks_in_line(p, chunk.line_end);
            std::int64_t value = 0;
            const unsigned char* const end =
                *p != chunk.line_end ? parse_integer(p, value) : nullptr;
            if (end == nullptr) refuse_number(p, chunk, "a vertex id of a face");
            p = end;
            const std::uint64_t id = static_cast<std::uint64_t>(value);  // negative: far beyond
            const bool is_vertex = id < header.n_vertices;
            is_in_range = is_in_range && is_vertex;
            face.add(is_vertex ? id : kNoVertex);
        }
        const auto place = [&] { return TextPlace{out.faces.n_faces, chunk.lines_before(line)}; };
        if (face.is_short()) {
            if (!out.dirt.short_face) out.dirt.short_face = place();
        } else if (!is_in_range && !out.dirt.out_of_range) {
            out.dirt.out_of_range = place();
        }
        face.finish(header.n_vertices);
        out.has_colors = out.has_colors ||
                         is_off_content(skip_blanks_in_line(p, chunk.line_end), chunk.line_end);
        return true;
    });
}

}  // namespace hewer::streaming
