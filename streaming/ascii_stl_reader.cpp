// SPDX-License-Identifier: MIT
#include "streaming/ascii_stl_reader.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "streaming/nonfinite.h"
#include "streaming/text_line.h"

namespace hewer::streaming {

namespace {

using SoupTriangle = std::array<Vec3, 3>;

/// Whether the token that begins at `p` is `word`, in small letters or capitals.
bool is_word(const unsigned char* p, std::string_view word) {
    for (const char c : word) {
        if ((*p++ | 0x20) != static_cast<unsigned char>(c)) return false;
    }
    return is_blank(*p);
}

/// Behind an "endfacet" that follows an "endloop": in the name of a solid, the word may stand
/// alone.
const unsigned char* find_facet_cut(const unsigned char* first, const unsigned char* from,
                                    const unsigned char* last, unsigned char /*line_end*/) {
    constexpr std::string_view kEnd = "endfacet";
    constexpr std::string_view kBefore = "endloop";
    constexpr std::ptrdiff_t kLength = kEnd.size();
    for (const unsigned char* p = from - first > kLength ? from - kLength : first;
         last - p > kLength; ++p) {
        if ((*p | 0x20) != 'e' || !is_word(p, kEnd)) continue;
        const unsigned char* before = p;
        while (before != first && is_blank(before[-1])) --before;
        constexpr std::ptrdiff_t kBeforeLength = kBefore.size();
        if (before != p && before - first >= kBeforeLength &&
            is_word(before - kBeforeLength, kBefore)) {
            return p + kLength;
        }
    }
    return nullptr;
}

/// What a chunk holds. Numbers count from the beginning of the chunk.
struct StlChunk {
    std::vector<SoupTriangle> triangles;
    std::uint64_t n_facets = 0;
    std::uint64_t n_nonfinite = 0;
    std::uint64_t n_short = 0;
    std::uint64_t n_polygons = 0;
    TextDirt dirt;
    bool has_colors = false;
    std::optional<bool> ends_in_solid;  ///< none: as before

    void clear() {
        triangles.clear();
        n_facets = n_nonfinite = n_short = n_polygons = 0;
        dirt = {};
        has_colors = false;
        ends_in_solid.reset();
    }
};

class Parser {
  public:
    Parser(const TextChunk& chunk, StlChunk& out)
        : chunk_(chunk), out_(out), p_(chunk.begin()), end_(chunk.end()) {}

    void run() {
        while (next()) {
            if (is_word(p_, "facet")) {
                facet();
            } else if (is_word(p_, "endsolid")) {
                out_.ends_in_solid = false;
                p_ = find_line_end(p_, end_, chunk_.line_end);
            } else if (is_word(p_, "solid")) {
                out_.ends_in_solid = true;
                p_ = find_line_end(p_, end_, chunk_.line_end);
            } else if (is_word(p_, "color")) {
                out_.has_colors = true;
                p_ = find_line_end(p_, end_, chunk_.line_end);
            } else {
                throw TextProblem{
                    p_, quote_token(p_, end_) + " stands where 'facet' or 'endsolid' should"};
            }
        }
    }

  private:
    /// Goes to the next token; false at the end.
    bool next() {
        p_ = skip_blanks(p_, end_);
        return p_ != end_;
    }
    void skip_tokens(int n) {
        for (; n > 0 && next(); --n) p_ = token_end(p_);
    }
    bool accept(std::string_view word) {
        if (!next() || !is_word(p_, word)) return false;
        p_ += word.size();
        return true;
    }
    void expect(std::string_view word) {
        if (accept(word)) return;
        if (p_ == end_) throw_truncated();
        throw TextProblem{
            p_, quote_token(p_, end_) + " stands where '" + std::string(word) + "' should"};
    }
    [[noreturn]] void throw_truncated() const {
        throw TextProblem{p_, "truncated: the file ends within a facet"};
    }

    void facet() {
        out_.ends_in_solid = true;
        const unsigned char* const facet = p_;
        p_ += std::string_view("facet").size();
        // Not a number, in some files.
        if (accept("normal")) skip_tokens(3);
        expect("outer");
        expect("loop");
        SoupTriangle triangle{};
        NonfiniteProbe probe;
        std::size_t n_corners = 0;
        const std::size_t n_before = out_.triangles.size();
        while (accept("vertex")) {
            Vec3 point;
            for (double& x : point) {
                if (!next()) throw_truncated();
                const unsigned char* const end = parse_double(p_, x);
                if (end == nullptr) refuse_number(p_, chunk_, "a number");
                p_ = end;
                probe.add(x);
            }
            // Beyond three: a fan.
            if (n_corners > 2) triangle[1] = triangle[2];
            triangle[std::min<std::size_t>(n_corners, 2)] = point;
            if (++n_corners > 2) out_.triangles.push_back(triangle);
        }
        expect("endloop");
        expect("endfacet");
        out_.n_polygons += n_corners > 3 ? 1 : 0;
        if (n_corners < 3) {
            if (out_.n_short++ == 0) out_.dirt.short_face = place(facet);
        } else if (probe.any()) {
            out_.triangles.resize(n_before);
            if (out_.n_nonfinite++ == 0) out_.dirt.nonfinite = place(facet);
        }
        ++out_.n_facets;
    }

    [[nodiscard]] TextPlace place(const unsigned char* p) const {
        return {out_.n_facets, chunk_.lines_before(p)};
    }

    const TextChunk& chunk_;
    StlChunk& out_;
    const unsigned char* p_;
    const unsigned char* end_;
};

class StlImport {
  public:
    StlImport(const ooc::InputFile& file, const OpenOptions& options, const Hooks& hooks,
              const TextTuning& tuning)
        : import_(file.path().string(), "STL, ASCII", file.size(), options, hooks),
          text_(file, import_, find_facet_cut, tuning),
          findings_(import_, file.path().string(), "triangle") {}

    std::unique_ptr<MeshSource> run() {
        text_.run<StlChunk>(
            text_.chunks(), 1,
            [](const TextChunk& chunk, StlChunk& found) {
                found.clear();
                Parser(chunk, found).run();
            },
            [&](const StlChunk& found, std::uint64_t line, std::uint64_t) {
                add(found, line);
                return true;
            });
        if (ends_in_solid_) {
            import_.ignore("that the last solid has no end: the file may have been cut short");
        }
        return import_.finish();
    }

  private:
    void add(const StlChunk& found, std::uint64_t line) {
        import_.defects().polygons += found.n_polygons;
        import_.defects().short_faces += found.n_short;
        import_.defects().nonfinite_triangles += found.n_nonfinite;
        findings_.note(found.dirt, n_facets_, n_facets_, line);
        import_.add_points(found.triangles);
        if (found.has_colors) import_.ignore("colours of facets");
        n_facets_ += found.n_facets;
        ends_in_solid_ = found.ends_in_solid.value_or(ends_in_solid_);
    }

    MeshImport import_;
    TextImport text_;
    TextFindings findings_;
    std::uint64_t n_facets_ = 0;
    bool ends_in_solid_ = true;
};

}  // namespace

std::unique_ptr<MeshSource> open_ascii_stl(const ooc::InputFile& file, const OpenOptions& options,
                                           const Hooks& hooks, const TextTuning& tuning) {
    return StlImport(file, options, hooks, tuning).run();
}

}  // namespace hewer::streaming
