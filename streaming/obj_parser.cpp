// SPDX-License-Identifier: MIT
#include "streaming/obj_parser.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <span>
#include <string_view>

#include "streaming/text_line.h"

namespace hewer::streaming {

namespace {

/// Statements that are not carried, and what to say of that: null where nothing is lost.
struct Statement {
    std::string_view word;
    const char* lost;
};
constexpr std::array<Statement, 17> kStatements{{
    {"g", nullptr},
    {"o", nullptr},
    {"s", nullptr},
    {"mg", nullptr},
    {"end", nullptr},
    {"vp", "points of parameter spaces"},
    {"usemap", "materials"},
    {"maplib", "materials"},
    {"l", "lines"},
    {"p", "points"},
    {"curv", "free-form curves and surfaces"},
    {"curv2", "free-form curves and surfaces"},
    {"surf", "free-form curves and surfaces"},
    {"cstype", "free-form curves and surfaces"},
    {"deg", "free-form curves and surfaces"},
    {"parm", "free-form curves and surfaces"},
    {"call", "files that this one calls"},
}};

/// Blanks in place of continuations, so that a line is a line. Comments end where they end: paths
/// of Windows in them may end with a backslash.
void join_continued_lines(TextChunk& chunk) {
    unsigned char* const begin = chunk.bytes.room_for(0) + chunk.skip;
    unsigned char* const end = begin + chunk.n_bytes;
    const unsigned char* line = begin;  // that `p` is in, joined ones being one
    for (unsigned char* p = begin; p != end; ++p) {
        const unsigned char* const seen = p;
        p = static_cast<unsigned char*>(std::memchr(p, '\\', static_cast<std::size_t>(end - p)));
        if (p == nullptr) return;
        for (const unsigned char* q = p; q != seen; --q) {
            if (q[-1] != chunk.line_end) continue;
            line = q;
            break;
        }
        unsigned char* after = p + 1;
        if (after != end && *after == '\r' && chunk.line_end != '\r') ++after;
        if (after == end || *after != chunk.line_end) continue;
        if (*skip_blanks_in_line(line, chunk.line_end) == '#') continue;
        *p = ' ';
        *after = TextChunk::kJoint;
        chunk.has_joined_lines = true;
    }
}

class Parser {
  public:
    Parser(const TextChunk& chunk, ObjChunk& out)
        : chunk_(chunk), out_(out), line_end_(chunk.line_end) {}

    /// Looks for the first face with a corner that is no vertex.
    void watch(std::uint64_t n_vertices, std::uint64_t n_vertices_before) {
        is_watching_ = true;
        n_vertices_ = n_vertices;
        n_vertices_before_ = n_vertices_before;
    }
    [[nodiscard]] const std::optional<TextPlace>& first_out_of_range() const {
        return first_out_of_range_;
    }

    void run() {
        const unsigned char* p = chunk_.begin();
        const unsigned char* const end = chunk_.end();
        while (p < end) {
            p = skip_blanks_in_line(p, line_end_);
            if (p[0] == 'v' && is_blank(p[1])) {
                p = vertex(p);
            } else if (p[0] == 'f' && is_blank(p[1])) {
                p = face(p);
            } else if (p[0] == 'v' && p[1] == 'n' && is_blank(p[2])) {
                p = normal(p);
            } else if (p[0] == 'v' && p[1] == 't' && is_blank(p[2])) {
                p = texcoord(p);
            } else if (*p != '#' && *p != line_end_) {
                other(p);
            }
            p = find_line_end(p, end, line_end_) + 1;
        }
    }

  private:
    [[nodiscard]] TextPlace place(std::uint64_t number, const unsigned char* p) const {
        return {number, chunk_.lines_before(p)};
    }
    void ignore(const std::string& what) {
        std::vector<std::string>& all = out_.ignored;
        if (std::find(all.begin(), all.end(), what) == all.end()) all.push_back(what);
    }

    const unsigned char* vertex(const unsigned char* line) {
        Vec3 position;
        bool is_finite = true;
        const unsigned char* p = read_position(line + 1, chunk_, position, is_finite);
        p = skip_blanks_in_line(p, line_end_);
        if (*p != line_end_) p = after_position(p);
        if (!is_finite && !out_.dirt.nonfinite) {
            out_.dirt.nonfinite = place(out_.positions.size(), line);
        }
        out_.positions.push_back(position);
        return p;
    }

    /// "x y z w", "x y z r g b" or "x y z r g b a".
    const unsigned char* after_position(const unsigned char* p) {
        std::array<double, 4> values{};
        std::size_t n = 0;
        const auto is_end = [&] { return *p == line_end_ || *p == '#'; };
        for (; !is_end() && n < values.size(); p = skip_blanks_in_line(p, line_end_)) {
            p = read_double(p, chunk_, values[n++]);
        }
        if (!is_end() || n == 2) ignore("numbers behind the position of a vertex");
        if (n == 1 && values[0] != 1) ignore("weights of vertices");
        if (n < 3) return p;
        out_.colors.resize(out_.positions.size(), kNoTextColor);
        out_.colors.push_back(make_text_color(std::span(values).first(n)));
        return p;
    }

    const unsigned char* normal(const unsigned char* line) {
        Vec3 normal;
        bool is_finite = true;
        const unsigned char* const p = read_position(line + 2, chunk_, normal, is_finite);
        out_.normals.push_back(to_normal(normal.data()));
        return p;
    }

    /// "u", "u v" or "u v w".
    const unsigned char* texcoord(const unsigned char* line) {
        double u = 0;
        double v = 0;
        const unsigned char* p = read_double(line + 2, chunk_, u);
        p = skip_blanks_in_line(p, line_end_);
        if (*p != line_end_ && *p != '#') p = read_double(p, chunk_, v);
        out_.texcoords.push_back({static_cast<float>(u), static_cast<float>(v)});
        return p;
    }

    const unsigned char* face(const unsigned char* line) {
        TextFace face(out_.faces);
        std::uint64_t highest_id = 0;
        bool is_in_range = true;
        const unsigned char* p = skip_blanks_in_line(line + 1, line_end_);
        while (*p != line_end_ && *p != '#') {
            std::uint64_t id = 0;
            std::uint64_t texcoord = 0;
            p = skip_blanks_in_line(corner(p, id, texcoord), line_end_);
            if (id <= ObjId::kNone) highest_id = std::max(highest_id, id);
            is_in_range = is_in_range && (!is_watching_ || is_vertex(id));
            face.add(id, texcoord);
        }
        if (!face.is_short()) {
            out_.highest_id = std::max(out_.highest_id, highest_id);
            if (!is_in_range && !first_out_of_range_) {
                first_out_of_range_ = place(out_.faces.n_faces, line);
            }
        } else if (!out_.dirt.short_face) {
            out_.dirt.short_face = place(out_.faces.n_faces, line);
        }
        face.finish(out_.positions.size());
        return p;
    }

    [[nodiscard]] bool is_vertex(std::uint64_t id) const {
        return ObjId::resolve(id, n_vertices_before_) < n_vertices_;
    }

    /// "v", "v/vt", "v//vn" or "v/vt/vn"; numbers behind the slashes may be missing.
    const unsigned char* corner(const unsigned char* p, std::uint64_t& id,
                                std::uint64_t& texcoord) {
        const unsigned char* const token = p;
        std::int64_t v = 0;
        std::int64_t vt = 0;
        std::int64_t vn = 0;
        bool has_normal = false;
        p = index(p, token, v);
        if (*p == '/') {
            ++p;
            if (*p != '/' && !is_blank(*p)) p = index(p, token, vt);
            if (*p == '/') {
                ++p;
                has_normal = !is_blank(*p);
                if (has_normal) p = index(p, token, vn);
            }
        }
        if (!is_blank(*p)) refuse_number(token, chunk_, "a corner of a face");
        id = to_id(v, out_.positions.size());
        if (v < 0) out_.has_relative_ids = true;
        texcoord = vt == 0 ? TextFaces::kNoTexcoord : to_id(vt, out_.texcoords.size());
        if (has_normal) {
            note_normal(v, vn);
        } else {
            out_.has_corners_without_normal = true;
        }
        return p;
    }

    /// As in ObjId; `n_before` elements stand in front, in the chunk.
    static std::uint64_t to_id(std::int64_t number, std::size_t n_before) {
        if (number > 0) return static_cast<std::uint64_t>(number - 1);
        if (number == 0) return ObjId::kNone;
        return ObjId::kRelative + n_before + static_cast<std::uint64_t>(number);
    }

    void note_normal(std::int64_t v, std::int64_t vn) {
        out_.has_corners_with_normal = true;
        if (v == vn && v > 0) return;
        if (v >= 0 || vn >= 0) {
            out_.has_other_normals = true;
            return;
        }
        const std::int64_t shift = (static_cast<std::int64_t>(out_.normals.size()) + vn) -
                                   (static_cast<std::int64_t>(out_.positions.size()) + v);
        if (!out_.relative_normal_shift) out_.relative_normal_shift = shift;
        if (*out_.relative_normal_shift != shift) out_.has_other_normals = true;
    }

    /// A whole number of at most 18 digits, at `p`.
    const unsigned char* index(const unsigned char* p, const unsigned char* token,
                               std::int64_t& value) const {
        const bool is_negative = *p == '-';
        if (is_negative) ++p;
        const unsigned char* const first = p;
        std::int64_t magnitude = 0;
        for (unsigned digit = *p - unsigned{'0'}; digit < 10; digit = *p - unsigned{'0'}) {
            if (p - first == 18) refuse_number(token, chunk_, "a corner of a face");
            magnitude = 10 * magnitude + static_cast<std::int64_t>(digit);
            ++p;
        }
        if (p == first) refuse_number(token, chunk_, "a corner of a face");
        value = is_negative ? -magnitude : magnitude;
        return p;
    }

    void other(const unsigned char* p) {
        const std::string_view word(reinterpret_cast<const char*>(p),
                                    static_cast<std::size_t>(token_end(p) - p));
        const auto* const it =
            std::find_if(kStatements.begin(), kStatements.end(),
                         [&](const Statement& statement) { return statement.word == word; });
        if (word == "usemtl" || word == "mtllib") {
            auto& lines = word == "usemtl" ? out_.used_materials : out_.material_files;
            lines.push_back({out_.faces.triangles.size(), rest_of_line(p + word.size())});
        } else if (it != kStatements.end()) {
            if (it->lost != nullptr) ignore(it->lost);
        } else if (std::isalpha(*p) != 0 || *p == '_') {
            if (out_.first_unknown.empty()) out_.first_unknown = quote_token(p, chunk_.end());
        } else {
            throw TextProblem{p, quote_token(p, chunk_.end()) +
                                     " begins no statement of OBJ (v, vn, vt, f, ...)"};
        }
    }

    /// Without the blanks around it.
    std::string rest_of_line(const unsigned char* p) const {
        p = skip_blanks_in_line(p, line_end_);
        const unsigned char* end = find_line_end(p, chunk_.end(), line_end_);
        while (end != p && is_blank(end[-1])) --end;
        return {reinterpret_cast<const char*>(p), static_cast<std::size_t>(end - p)};
    }

    const TextChunk& chunk_;
    ObjChunk& out_;
    unsigned char line_end_;
    bool is_watching_ = false;
    std::uint64_t n_vertices_ = 0;
    std::uint64_t n_vertices_before_ = 0;
    std::optional<TextPlace> first_out_of_range_;
};

}  // namespace

void ObjChunk::clear() {
    positions.clear();
    colors.clear();
    normals.clear();
    texcoords.clear();
    faces.clear();
    dirt = {};
    highest_id = 0;
    has_relative_ids = false;
    has_corners_without_normal = false;
    has_corners_with_normal = false;
    has_other_normals = false;
    relative_normal_shift.reset();
    used_materials.clear();
    material_files.clear();
    ignored.clear();
    first_unknown.clear();
}

void parse_obj(TextChunk& chunk, ObjChunk& out) {
    out.clear();
    join_continued_lines(chunk);
    Parser(chunk, out).run();
}

std::optional<TextPlace> find_out_of_range(TextChunk& chunk, std::uint64_t n_vertices,
                                           std::uint64_t n_vertices_before) {
    ObjChunk found;
    join_continued_lines(chunk);
    Parser parser(chunk, found);
    parser.watch(n_vertices, n_vertices_before);
    parser.run();
    return parser.first_out_of_range();
}

}  // namespace hewer::streaming
