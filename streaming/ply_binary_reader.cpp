// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <utility>

#include "hewer/error.h"
#include "streaming/ply_face_decoder.h"
#include "streaming/ply_reader.h"
#include "streaming/ply_source.h"
#include "streaming/ply_vertex_decoder.h"
#include "streaming/row_reader.h"

namespace hewer::streaming {

namespace {

/// A block of raw rows, and room for their scalars without the lists between them.
struct BinaryBlock : RowBlock {
    ByteBuffer packed;
};

class BinaryEncoding {
  public:
    using Stream = BinaryStream;
    using Reader = RowReader;
    using Block = BinaryBlock;
    struct Position {
        std::uint64_t offset;
    };

    BinaryEncoding(const ooc::InputFile& file, std::atomic<std::uint64_t>& n_bytes_read,
                   const PlyHeader& header, const PlyLayout& layout)
        : file_(file),
          n_bytes_read_(n_bytes_read),
          fields_(layout.vertex),
          swap_((header.encoding == PlyEncoding::LittleEndian) !=
                (std::endian::native == std::endian::little)) {}

    static RowShape shape(const PlyElement& element) { return RowShape::in_bytes(element); }
    static std::uint64_t min_row_bytes(const RowShape& shape) { return shape.min_units; }
    static Position begin(const PlyHeader& header) { return {header.n_bytes}; }
    static Position position(const Stream& stream) { return {stream.offset()}; }
    static Position position(const Reader& reader) { return {reader.offset()}; }

    Stream stream(const Position& start) const {
        return {file_, n_bytes_read_, start.offset, swap_};
    }
    std::unique_ptr<Reader> reader(const RowShape& shape, const Position& start,
                                   std::size_t fan_list) const {
        return std::make_unique<Reader>(file_, n_bytes_read_, shape, swap_, start.offset, fan_list);
    }

    static bool can_seek(const RowShape& shape) { return shape.lists.empty(); }
    void read_rows(const RowShape& shape, const Position& start, std::uint64_t first,
                   std::uint64_t n, BinaryBlock& block) const {
        block.stride = shape.fixed_units;
        block.first_row = first;
        block.n_rows = n;
        block.offset = start.offset + first * block.stride;
        block.n_bytes = static_cast<std::size_t>(n) * block.stride;
        const std::size_t got =
            file_.read_at(block.offset, block.bytes.room_for(block.n_bytes), block.n_bytes);
        n_bytes_read_.fetch_add(got, std::memory_order_relaxed);
        if (got != block.n_bytes) {
            throw FormatError(file_.path().string() + ": byte " +
                              std::to_string(block.offset + got) +
                              ": truncated while it was being read");
        }
    }

    std::uint64_t decode_vertices(const RowShape& shape, BinaryBlock& block,
                                  VertexBatch& batch) const {
        const std::size_t n = static_cast<std::size_t>(block.n_rows);
        if (shape.lists.empty()) {
            return streaming::decode_vertices(fields_, {block.bytes.data(), block.stride, n, swap_},
                                              batch);
        }
        pack_scalars(shape, block);
        return streaming::decode_vertices(
            fields_, {block.packed.data(), shape.fixed_units, n, swap_}, batch);
    }

    FaceFindings decode_faces(const RowShape& shape, std::size_t list, ScalarType id_type,
                              const BinaryBlock& block, std::uint64_t n_vertices,
                              TriangleBatch& batch) const {
        return streaming::decode_faces(shape, swap_, list, id_type, n_vertices, block, batch);
    }

    std::uint64_t trailing_bytes(std::uint64_t offset) const {
        return file_.size() - std::min(offset, file_.size());
    }

    std::string place(const RowShape& shape, const BinaryBlock& block, std::uint64_t row) const {
        std::uint64_t offset = 0;
        if (block.stride != 0) {
            offset = row * block.stride;
        } else {
            for (; row > 0; --row) {
                offset +=
                    walk_row(shape, swap_, block.bytes.data() + offset, block.n_bytes - offset,
                             [](std::size_t, const unsigned char*, std::uint64_t) {});
            }
        }
        return "byte " + std::to_string(block.offset + offset);
    }

  private:
    void pack_scalars(const RowShape& shape, BinaryBlock& block) const {
        unsigned char* out =
            block.packed.room_for(static_cast<std::size_t>(block.n_rows) * shape.fixed_units);
        const unsigned char* p = block.bytes.data();
        const unsigned char* const end = p + block.n_bytes;
        for (std::uint64_t row = 0; row < block.n_rows; ++row) {
            const std::size_t row_bytes =
                walk_row(shape, swap_, p, static_cast<std::size_t>(end - p),
                         [&](std::size_t i, const unsigned char* items, std::uint64_t) {
                             const RowList& list = shape.lists[i];
                             out = std::copy_n(items - list.count_units - list.gap, list.gap, out);
                         });
            p += row_bytes;
            out = std::copy_n(p - shape.tail, shape.tail, out);
        }
    }

    const ooc::InputFile& file_;
    std::atomic<std::uint64_t>& n_bytes_read_;
    PlyVertexFields fields_;
    bool swap_;
};

}  // namespace

std::unique_ptr<MeshSource> open_binary_ply(std::shared_ptr<const ooc::InputFile> file,
                                            PlyHeader header, const OpenOptions& options) {
    return std::make_unique<PlySource<BinaryEncoding>>(std::move(file), std::move(header), options);
}

}  // namespace hewer::streaming
