// SPDX-License-Identifier: MIT
#include "streaming/off_header.h"

#include <algorithm>
#include <string_view>

#include "hewer/error.h"
#include "streaming/text_chunks.h"
#include "streaming/text_line.h"

namespace hewer::streaming {

namespace {

constexpr std::size_t kHeaderBytes = 64 << 10;

/// The first kilobytes as a chunk, for the messages; a line end follows.
class HeaderParser {
  public:
    explicit HeaderParser(const ooc::InputFile& file) : file_(file) {
        const TextHead head(file);
        unsigned char* const bytes = chunk_.bytes.room_for(kHeaderBytes + 1);
        chunk_.n_bytes = file.read_at(0, bytes, kHeaderBytes);
        chunk_.line_end = head.line_end;
        bytes[chunk_.n_bytes] = head.line_end;
        p_ = chunk_.begin() + head.n_skipped;
    }

    OffHeader parse() try {
        OffHeader header;
        keyword(header);
        header.n_vertices = count("the number of vertices");
        header.n_faces = count("the number of faces");
        // The number of edges, if it is there, is of no use.
        p_ = find_line_end(p_, chunk_.end(), chunk_.line_end);
        p_ = std::min(p_ + 1, chunk_.end());
        header.n_bytes = static_cast<std::uint64_t>(p_ - chunk_.begin());
        header.n_lines = chunk_.lines_before(p_);
        return header;
    } catch (const TextProblem& problem) {
        throw FormatError(file_.path().string() + ": line " +
                          std::to_string(1 + chunk_.lines_before(problem.at)) + ": " +
                          problem.what);
    }

  private:
    /// Goes to the next token that is in no comment.
    void next() {
        for (;;) {
            p_ = skip_blanks(p_, chunk_.end());
            if (p_ == chunk_.end() || *p_ != '#') return;
            p_ = find_line_end(p_, chunk_.end(), chunk_.line_end);
        }
    }

    /// [ST][C][N][4][n]OFF. MeshLab writes NCOFF, with the colours in front of the normals. The
    /// first count may stick to the word, as in ModelNet.
    void keyword(OffHeader& header) {
        next();
        const unsigned char* const token = p_;
        const std::string_view word(reinterpret_cast<const char*>(p_),
                                    static_cast<std::size_t>(token_end(p_) - p_));
        const std::size_t off = word.find("OFF");
        if (off == word.npos) {
            throw TextProblem{token, quote_token(token, chunk_.end()) +
                                         " stands where 'OFF' should, or COFF, NOFF, CNOFF, ..."};
        }
        for (std::string_view rest = word.substr(0, off); !rest.empty();) {
            const bool is_texture = rest.substr(0, 2) == "ST";
            header.has_texture = header.has_texture || is_texture;
            header.has_colors = header.has_colors || rest[0] == 'C';
            header.has_colors_first =
                header.has_colors_first || (rest[0] == 'C' && header.has_normals);
            header.has_normals = header.has_normals || rest[0] == 'N';
            if (rest[0] == '4' || rest[0] == 'n') {
                throw TextProblem{token, quote_token(token, chunk_.end()) +
                                             ": hewer reads three dimensions only"};
            }
            if (!is_texture && rest[0] != 'C' && rest[0] != 'N') {
                throw TextProblem{token, quote_token(token, chunk_.end()) + " is no kind of OFF"};
            }
            rest.remove_prefix(is_texture ? 2 : 1);
        }
        header.name = word.substr(0, off + 3);
        p_ += off + 3;
        const unsigned char* const after = skip_blanks_in_line(p_, chunk_.line_end);
        constexpr std::string_view kBinary = "BINARY";
        const std::string_view argument(reinterpret_cast<const char*>(after),
                                        static_cast<std::size_t>(token_end(after) - after));
        if (argument == kBinary) {
            throw TextProblem{
                after, "binary OFF is not read; write it as text, or as PLY, with another program"};
        }
    }

    std::uint64_t count(const char* what) {
        next();
        std::int64_t value = 0;
        const unsigned char* const end = p_ != chunk_.end() ? parse_integer(p_, value) : nullptr;
        if (end == nullptr || value < 0) refuse_number(p_, chunk_, what);
        p_ = end;
        return static_cast<std::uint64_t>(value);
    }

    const ooc::InputFile& file_;
    TextChunk chunk_;
    const unsigned char* p_ = nullptr;
};

}  // namespace

OffHeader read_off_header(const ooc::InputFile& file) {
    return HeaderParser(file).parse();
}

}  // namespace hewer::streaming
