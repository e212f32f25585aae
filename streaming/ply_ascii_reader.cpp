// SPDX-License-Identifier: MIT
#include <array>
#include <utility>

#include "hewer/error.h"
#include "streaming/number_parser.h"
#include "streaming/ply_reader.h"
#include "streaming/ply_source.h"
#include "streaming/ply_vertex_decoder.h"
#include "streaming/text_reader.h"

namespace hewer::streaming {

namespace {

/// One step through a row of text.
struct Step {
    enum class Kind : std::uint8_t { Skip, Store, SkipList };
    Kind kind = Kind::Skip;
    ScalarType type = ScalarType::Float32;
    std::size_t offset = 0;  ///< of a scalar that is stored, in the packed row
};

/// Vertices are parsed into rows of binary scalars of the declared types, so that from there on
/// both encodings share one decoder and give equal values: a float is rounded to a float.
class AsciiEncoding {
  public:
    using Stream = TextStream;
    using Reader = TextReader;
    using Block = TextBlock;
    struct Position {
        std::uint64_t offset;
        std::uint64_t line;
    };

    AsciiEncoding(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
                  const PlyHeader& header, const PlyLayout& layout)
        : file_(file), n_bytes_read_(n_bytes_read), fields_(layout.vertex) {
        for (const PlyProperty& p : header.elements[layout.vertex_element].properties) {
            if (p.is_list) {
                steps_.push_back({Step::Kind::SkipList, p.type, 0});
                continue;
            }
            const bool is_carried = is_field(packed_bytes_);
            steps_.push_back(
                {is_carried ? Step::Kind::Store : Step::Kind::Skip, p.type, packed_bytes_});
            packed_bytes_ += byte_size(p.type);
        }
    }

    static RowShape shape(const PlyElement& element) { return RowShape::in_tokens(element); }
    static bool can_seek(const RowShape&) { return false; }
    void read_rows(const RowShape&, const Position&, std::uint64_t, std::uint64_t,
                   TextBlock&) const {
        throw InternalError("lines of text have no fixed length");
    }
    /// A character a token, a blank between two.
    static std::uint64_t min_row_bytes(const RowShape& shape) {
        return shape.min_units == 0 ? 0 : 2 * shape.min_units - 1;
    }
    static Position begin(const PlyHeader& header) { return {header.n_bytes, header.n_lines + 1}; }
    static Position position(const Stream& stream) { return {stream.offset(), stream.line()}; }
    static Position position(const Reader& reader) { return {reader.offset(), reader.line()}; }

    Stream stream(const Position& start) const {
        return {file_, n_bytes_read_, start.offset, start.line};
    }
    std::unique_ptr<Reader> reader(const RowShape& shape, const Position& start,
                                   std::size_t fan_list) const {
        return std::make_unique<Reader>(file_, n_bytes_read_, shape, start.offset, start.line,
                                        fan_list);
    }

    std::uint64_t decode_vertices(const RowShape& shape, TextBlock& block,
                                  VertexBatch& batch) const {
        const std::size_t n = static_cast<std::size_t>(block.n_rows);
        unsigned char* const packed = block.packed.room_for(n * packed_bytes_);
        const unsigned char* p = block.bytes.data();
        const unsigned char* const end = p + block.n_bytes + 1;  // with the last token's blank
        for (std::size_t row = 0; row < n; ++row) {
            for (const Step& step : steps_) {
                p = skip_blanks(p, end);
                const unsigned char* const token = p;
                if (step.kind == Step::Kind::Store) {
                    double value = 0;
                    p = parse_double(token, value);
                    if (p == nullptr) fail_number(shape, block, row, token);
                    store_scalar(step.type, value, packed + row * packed_bytes_ + step.offset);
                } else if (step.kind == Step::Kind::Skip) {
                    p = skip_tokens(p, end, 1);
                } else {
                    p = skip_list(token, end);
                }
            }
        }
        return streaming::decode_vertices(fields_, {packed, packed_bytes_, n, false}, batch);
    }

    FaceFindings decode_faces(const RowShape& shape, std::size_t list, ScalarType /*id_type*/,
                              const TextBlock& block, std::uint64_t n_vertices,
                              TriangleBatch& batch) const {
        batch.corners.resize(block.n_triangles);
        FanWriter fans(batch.corners.data(), n_vertices);
        const unsigned char* p = block.bytes.data();
        const unsigned char* const end = p + block.n_bytes + 1;
        for (std::uint64_t row = 0; row < block.n_rows; ++row) {
            for (std::size_t i = 0; i < shape.lists.size(); ++i) {
                p = skip_blanks(skip_tokens(p, end, shape.lists[i].gap), end);
                std::int64_t count = 0;
                p = parse_integer(p, count);
                const std::uint64_t n = static_cast<std::uint64_t>(count);
                if (i != list) {
                    p = skip_tokens(p, end, n);
                    continue;
                }
                fans.add(row, n, [&] {
                    const unsigned char* const token = skip_blanks(p, end);
                    std::int64_t id = 0;
                    p = parse_integer(token, id);
                    if (p == nullptr) fail_number(shape, block, row, token);
                    return static_cast<std::uint64_t>(id);
                });
            }
            p = skip_tokens(p, end, shape.tail);
        }
        batch.corners.resize(static_cast<std::size_t>(fans.end() - batch.corners.data()));
        return fans.findings();
    }

    /// Blank lines say nothing.
    std::uint64_t trailing_bytes(std::uint64_t offset) const {
        std::array<unsigned char, 4096> bytes{};
        while (const std::size_t n = file_.read_at(offset, bytes.data(), bytes.size())) {
            const unsigned char* const end = bytes.data() + n;
            const unsigned char* const first = skip_blanks(bytes.data(), end);
            offset += static_cast<std::uint64_t>(first - bytes.data());
            if (first != end) return file_.size() - offset;
        }
        return 0;
    }

    static std::string place(const RowShape& shape, const TextBlock& block, std::uint64_t row) {
        const unsigned char* p = block.bytes.data();
        const unsigned char* const end = p + block.n_bytes + 1;
        for (; row > 0; --row) {
            for (const RowList& list : shape.lists) {
                p = skip_list(skip_blanks(skip_tokens(p, end, list.gap), end), end);
            }
            p = skip_tokens(p, end, shape.tail);
        }
        return "line " + std::to_string(line_of(block, skip_blanks(p, end)));
    }

  private:
    /// The place after the list whose count is at `p`; the reader has checked the count.
    static const unsigned char* skip_list(const unsigned char* p, const unsigned char* end) {
        std::int64_t count = 0;
        p = parse_integer(p, count);
        return skip_tokens(p, end, static_cast<std::uint64_t>(count));
    }

    /// Whether a carried property stands at `offset` of the packed row.
    [[nodiscard]] bool is_field(std::size_t offset) const {
        const auto is_here = [&](const std::array<PlyField, 3>& triple) {
            return std::any_of(triple.begin(), triple.end(),
                               [&](const PlyField& f) { return f.offset == offset; });
        };
        return is_here(fields_.position) || (fields_.normal && is_here(*fields_.normal)) ||
               (fields_.color && is_here(*fields_.color)) ||
               (fields_.alpha && fields_.alpha->offset == offset) ||
               (fields_.weight && fields_.weight->offset == offset);
    }

    [[noreturn]] void fail_number(const RowShape& shape, const TextBlock& block, std::uint64_t row,
                                  const unsigned char* token) const {
        throw FormatError(file_.path().string() + ": line " +
                          std::to_string(line_of(block, token)) + ", " + shape.element + " " +
                          std::to_string(block.first_row + row) + ": '" + token_text(block, token) +
                          "' is not a number that fits here");
    }

    const ooc::InputFile& file_;
    std::atomic<std::uint64_t>& n_bytes_read_;
    PlyVertexFields fields_;
    std::vector<Step> steps_;
    std::size_t packed_bytes_ = 0;
};

}  // namespace

std::unique_ptr<MeshSource> open_ascii_ply(std::shared_ptr<const ooc::InputFile> file,
                                           PlyHeader header, const OpenOptions& options) {
    return std::make_unique<PlySource<AsciiEncoding>>(std::move(file), std::move(header), options);
}

}  // namespace hewer::streaming
