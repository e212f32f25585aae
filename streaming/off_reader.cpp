// SPDX-License-Identifier: MIT
#include "streaming/off_reader.h"

#include <string>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/face_import.h"
#include "streaming/off_header.h"
#include "streaming/off_parser.h"
#include "streaming/text_colors.h"

namespace hewer::streaming {

namespace {

class OffImport {
  public:
    OffImport(const ooc::InputFile& file, const OpenOptions& options, const Hooks& hooks,
              const TextTuning& tuning)
        : file_(file),
          header_(read_off_header(file)),
          import_(file.path().string(), header_.name, file.size(), options, hooks),
          text_(file, import_, find_line_cut, tuning),
          findings_(import_, file.path().string(), "vertex"),
          colors_(import_),
          faces_(import_, header_.n_vertices) {}

    std::unique_ptr<MeshSource> run() {
        const Place faces = find_faces();
        read_vertices(faces);
        read_faces(faces);
        if (header_.has_texture) import_.ignore("texture coordinates");
        colors_.finish();
        faces_.finish();
        return import_.finish();
    }

  private:
    struct Place {
        std::uint64_t offset;
        std::uint64_t line;
    };

    [[noreturn]] void fail_truncated(std::uint64_t n, std::uint64_t n_announced,
                                     const char* elements) const {
        throw FormatError(file_.path().string() + ": truncated: the file ends after " +
                          ooc::format_count(n) + " of the " + ooc::format_count(n_announced) + " " +
                          elements + " that its header announces");
    }

    /// The line that the faces begin in, behind those of the vertices.
    Place find_faces() {
        const TextChunks body = text_.chunks().part(header_.n_bytes, file_.size());
        TextChunk chunk;
        std::uint64_t n = 0;
        std::uint64_t line = 1 + header_.n_lines;
        for (std::uint64_t i = 0; i < body.size(); ++i) {
            body.read(i, chunk);
            if (chunk.is_too_long) break;  // refused where it is parsed
            const unsigned char* first_face = nullptr;
            for_off_lines(chunk, [&](const unsigned char* p) {
                if (n++ == header_.n_vertices) first_face = p;
                return first_face == nullptr;
            });
            if (first_face != nullptr) {
                // With the blanks in front: where a line begins.
                while (first_face != chunk.begin() && first_face[-1] != chunk.line_end) {
                    --first_face;
                }
                return {chunk.offset + static_cast<std::uint64_t>(first_face - chunk.begin()),
                        line + chunk.lines_before(first_face)};
            }
            line += chunk.n_lines;
            import_.context().check_stop();
        }
        if (n < header_.n_vertices) fail_truncated(n, header_.n_vertices, "vertices");
        return {file_.size(), line};
    }

    void read_vertices(const Place& faces) {
        text_.run<OffVertices>(
            text_.chunks().part(header_.n_bytes, faces.offset), 1 + header_.n_lines,
            [&](const TextChunk& chunk, OffVertices& found) {
                parse_off_vertices(header_, chunk, found);
            },
            [&](const OffVertices& found, std::uint64_t line, std::uint64_t) {
                findings_.note(found.dirt, import_.n_vertices(), 0, line);
                import_.add_vertices({found.positions, found.normals, {}});
                colors_.add(found.colors, found.positions.size());
                if (found.has_other_numbers) {
                    import_.ignore("numbers behind the position of a vertex");
                }
                return true;
            });
    }

    void read_faces(const Place& faces) {
        const TextChunks part = text_.chunks().part(faces.offset, file_.size());
        std::uint64_t n_read = 0;
        text_.run<OffFaces>(
            part, faces.line,
            [&](const TextChunk& chunk, OffFaces& found) {
                parse_off_faces(header_, header_.n_faces, chunk, found);
            },
            [&](OffFaces& found, std::uint64_t line, std::uint64_t i) {
                const std::uint64_t n_wanted = header_.n_faces - n_read;
                const bool is_last = found.n_lines > n_wanted;
                if (is_last) {
                    TextChunk chunk;
                    part.read(i, chunk);
                    parse_off_faces(header_, n_wanted, chunk, found);
                    import_.ignore("lines after the last face");
                }
                findings_.note(found.dirt, 0, n_read, line);
                n_read += found.faces.n_faces;
                faces_.add(found.faces, 0);
                if (found.has_colors) import_.ignore("colours of faces");
                return !is_last;
            });
        if (n_read < header_.n_faces) fail_truncated(n_read, header_.n_faces, "faces");
    }

    const ooc::InputFile& file_;
    OffHeader header_;
    MeshImport import_;
    TextImport text_;
    TextFindings findings_;
    TextColors colors_;
    FaceImport faces_;
};

}  // namespace

std::unique_ptr<MeshSource> open_off(const ooc::InputFile& file, const OpenOptions& options,
                                     const Hooks& hooks, const TextTuning& tuning) {
    return OffImport(file, options, hooks, tuning).run();
}

}  // namespace hewer::streaming
