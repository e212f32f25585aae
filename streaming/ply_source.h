// SPDX-License-Identifier: MIT
/// What the binary and the ASCII PLY reader have in common: passes over elements in any order.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/block_pool.h"
#include "streaming/findings.h"
#include "streaming/ply_layout.h"
#include "streaming/ply_rows.h"
#include "streaming/strip_reader.h"

namespace hewer::streaming {

/// A PLY file as a MeshSource. Encoding says how rows are read and decoded:
///   Stream, Reader, Block                   walk in sequence; hand out blocks; a block
///   Position                                where an element begins
///   shape(element), min_row_bytes(shape)    in the encoding's units
///   begin(header), position(x)              first position; that of a Stream or a finished Reader
///   stream(position), reader(...)           made there
///   decode_vertices(block, batch)           returns the first non-finite row, or n_rows
///   decode_faces(block, batch)              returns FaceFindings
///   place(element_shape, block, row)        "byte 1234" or "line 17"
///   can_seek(shape), read_rows(...)         rows by number, if they are all of one length
///   trailing_bytes(offset)                  of what is from there on, if it says anything
///
/// Elements stand one after the other, and where one begins is known only when those before it have
/// been walked, if they have lists. Each start is remembered once it is known, most often as the
/// end of a pass over the element before; only reading out of order costs a scan.
template <typename Encoding>
class PlySource final : public MeshSource {
  public:
    PlySource(std::shared_ptr<const ooc::InputFile> file, PlyHeader header,
              const OpenOptions& options)
        : file_(std::move(file)),
          header_(std::move(header)),
          layout_(plan_ply(header_, file_->path(), info_, options.weight_property)),
          reporter_(info_.name, options.strict),
          encoding_(*file_, n_bytes_read_, header_, layout_),
          starts_(header_.elements.size() + 1) {
        info_.n_bytes = file_->size();
        starts_[0] = encoding_.begin(header_);
        std::uint64_t offset = header_.n_bytes;
        for (const PlyElement& element : header_.elements) {
            shapes_.push_back(Encoding::shape(element));
            const std::uint64_t min_row_bytes = Encoding::min_row_bytes(shapes_.back());
            check_row_count(*file_, shapes_.back(), offset, min_row_bytes);
            offset += element.count * min_row_bytes;
        }
        corner_list_ = list_index(face_element(), layout_.corner_property);
        if (layout_.is_strips) info_.n_faces = count_strip_triangles();
    }

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] std::uint64_t bytes_read() const override { return n_bytes_read_.load(); }
    [[nodiscard]] std::uint64_t held_temp_bytes() const override {
        return file_->held_temp_bytes();
    }

    void begin_vertices() override {
        const Position start = start_of(layout_.vertex_element);
        vertex_reader_ = encoding_.reader(shapes_[layout_.vertex_element], start, 0);
    }

    bool next_vertices(VertexBatch& batch) override {
        if (!vertex_reader_) throw InternalError("next_vertices() before begin_vertices()");
        const auto block = blocks_.lease();
        if (!vertex_reader_->next(*block)) return false;
        batch.first = block->first_row;
        batch.defects = {};
        const RowShape& shape = shapes_[layout_.vertex_element];
        const std::uint64_t row = encoding_.decode_vertices(shape, *block, batch);
        if (row < block->n_rows) {
            reporter_.report_nonfinite(batch, block->first_row + row,
                                       [&] { return encoding_.place(shape, *block, row); });
        }
        return true;
    }

    [[nodiscard]] bool can_seek_vertices() const override {
        return Encoding::can_seek(shapes_[layout_.vertex_element]);
    }
    void read_vertices(std::uint64_t first, std::uint64_t n, VertexBatch& batch) override {
        const auto block = blocks_.lease();
        const RowShape& shape = shapes_[layout_.vertex_element];
        encoding_.read_rows(shape, *starts_[layout_.vertex_element], first, n, *block);
        batch.first = first;
        batch.defects = {};  // met in the pass before
        encoding_.decode_vertices(shape, *block, batch);
    }

    void begin_triangles() override {
        const Position start = start_of(layout_.face_element);
        if (layout_.is_strips) {
            strip_reader_ = make_strip_reader(start);
        } else {
            face_reader_ = encoding_.reader(shapes_[layout_.face_element], start, corner_list_);
        }
    }

    bool next_triangles(TriangleBatch& batch) override {
        batch.points.clear();
        batch.defects = {};
        if (strip_reader_) return next_strip_triangles(batch);
        if (!face_reader_) throw InternalError("next_triangles() before begin_triangles()");
        const auto block = blocks_.lease();
        if (!face_reader_->next(*block)) return false;
        batch.first_face = block->first_row;
        batch.n_faces = block->n_rows;
        const RowShape& shape = shapes_[layout_.face_element];
        const FaceFindings findings = encoding_.decode_faces(
            shape, corner_list_, face_element().properties[layout_.corner_property].type, *block,
            info_.n_vertices, batch);
        reporter_.report_faces(findings, batch, info_.n_vertices, [&](std::uint64_t row) {
            return encoding_.place(shape, *block, row);
        });
        const bool is_last = layout_.face_element + 1 == header_.elements.size() &&
                             block->first_row + block->n_rows == shape.n_rows;
        if (is_last) {
            batch.defects.trailing_bytes =
                encoding_.trailing_bytes(Encoding::position(*face_reader_).offset);
        }
        return true;
    }

  private:
    using Position = typename Encoding::Position;
    using Stream = typename Encoding::Stream;

    [[nodiscard]] const PlyElement& face_element() const {
        return header_.elements[layout_.face_element];
    }

    std::unique_ptr<StripReader<Stream>> make_strip_reader(const Position& start) {
        return std::make_unique<StripReader<Stream>>(
            ListItems<Stream>(encoding_.stream(start), shapes_[layout_.face_element], corner_list_,
                              face_element().properties[layout_.corner_property].type));
    }

    /// The number of rows says nothing about the triangles in them; a whole model is often one row.
    std::uint64_t count_strip_triangles() {
        const auto strips = make_strip_reader(start_of(layout_.face_element));
        std::uint64_t n = 0;
        for (Triangle t; strips->next(t);) ++n;
        if (n == 0) {
            throw FormatError(info_.name + ": the mesh has no faces: its strips hold no triangle");
        }
        return n;
    }

    bool next_strip_triangles(TriangleBatch& batch) {
        FaceFindings findings;
        std::string place;
        if (!strip_reader_->next(batch, info_.n_vertices, findings, place)) return false;
        reporter_.report_faces(findings, batch, info_.n_vertices,
                               [&](std::uint64_t) { return place; });
        return true;
    }

    Position start_of(std::size_t element) {
        remember_end(vertex_reader_.get(), layout_.vertex_element);
        remember_end(face_reader_.get(), layout_.face_element);
        std::size_t known = element;
        while (!starts_[known]) --known;
        for (; known < element; ++known) {
            Stream stream = encoding_.stream(*starts_[known]);
            check_rows(known, stream.offset());
            skip_rows(stream, shapes_[known]);
            starts_[known + 1] = Encoding::position(stream);
        }
        check_rows(element, starts_[element]->offset);
        return *starts_[element];
    }

    void check_rows(std::size_t element, std::uint64_t offset) const {
        const RowShape& shape = shapes_[element];
        check_row_count(*file_, shape, offset, Encoding::min_row_bytes(shape));
    }

    void remember_end(const typename Encoding::Reader* reader, std::size_t element) {
        if (reader != nullptr && reader->is_at_end()) {
            starts_[element + 1] = Encoding::position(*reader);
        }
    }

    std::shared_ptr<const ooc::InputFile> file_;
    PlyHeader header_;
    SourceInfo info_;
    PlyLayout layout_;
    FindingsReporter reporter_;
    std::atomic<std::uint64_t> n_bytes_read_{0};
    Encoding encoding_;
    std::vector<RowShape> shapes_;                 // by element
    std::vector<std::optional<Position>> starts_;  // by element, one more for the end
    std::size_t corner_list_ = 0;
    std::unique_ptr<typename Encoding::Reader> vertex_reader_;
    std::unique_ptr<typename Encoding::Reader> face_reader_;
    std::unique_ptr<StripReader<Stream>> strip_reader_;
    BlockPool<typename Encoding::Block> blocks_;
};

}  // namespace hewer::streaming
