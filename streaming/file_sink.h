// SPDX-License-Identifier: MIT
/// What the writers of all formats share: the file, the bookkeeping, the blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"
#include "ooc/file.h"

namespace hewer::streaming {

/// A MeshSink that holds its callers to the contract of MeshSink and leaves to a format only the
/// layout. begin() once, then all announced vertices, then all announced triangles with ids below
/// the number of vertices (or, where the format takes points, all triangles as points), then
/// finish(): everything else is an InternalError before a wrong byte
/// can get its name. Normals and colours must come with every vertex if they were announced and are
/// passed over if they were not.
///
/// The file is opened by the constructor, so that a path that cannot be written fails before any
/// work, and gets its name in finish() (see OutputFile). Memory: kFileSinkBytes, whatever the size
/// of the mesh or of the spans; a format that holds more says so. One thread.
class FileSink : public MeshSink {
  public:
    void begin(const SinkHeader& header) final;
    void add_vertices(const VertexSpan& vertices) final;
    void add_triangles(std::span<const Triangle> triangles) final;
    void add_points(std::span<const std::array<Vec3, 3>> triangles) final;
    void finish() final;
    /// The file then gets its name from group.publish(), after finish(). Before finish().
    virtual void publish_with(ooc::OutputGroup& group) { file_.publish_with(group); }
    [[nodiscard]] std::uint64_t bytes_written() const override { return file_.bytes_written(); }

  protected:
    /// Throws IoError as OutputFile does.
    FileSink(const std::filesystem::path& path, bool overwrite);

    /// What comes before the first vertex. Throws InvalidArgument if the format cannot hold the
    /// mesh.
    virtual void write_header() = 0;
    virtual void write_vertices(const VertexSpan& vertices) = 0;
    virtual void write_triangles(std::span<const Triangle> triangles) = 0;
    /// Overridden with takes_points().
    virtual void write_points(std::span<const std::array<Vec3, 3>> triangles);
    /// What comes after the last triangle.
    virtual void write_end() {}

    /// Writes records 0..n-1 through a block of fixed size. fill(i, out) stores record i at `out`,
    /// at most `largest` bytes, and returns its end.
    template <typename Fill>
    void write_records(std::size_t n, std::size_t largest, const Fill& fill) {
        char* const begin = block_.data();
        char* const last = begin + block_.size() - largest;
        char* out = begin;
        for (std::size_t i = 0; i < n; ++i) {
            if (out > last) {
                data().write(begin, static_cast<std::size_t>(out - begin));
                out = begin;
            }
            out = fill(i, out);
        }
        data().write(begin, static_cast<std::size_t>(out - begin));
    }

    [[nodiscard]] const SinkHeader& header() const { return header_; }
    [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }
    ooc::OutputFile& file() { return file_; }
    /// Where write_records() writes to.
    virtual ooc::OutputFile& data() { return file_; }

    static constexpr std::size_t kBlockBytes = 64 << 10;

  private:
    enum class State { Opened, Begun, Finished };
    void require(bool holds, const std::string& what) const;
    void count_triangles(std::size_t n);

    ooc::OutputFile file_;
    std::vector<char> block_;
    SinkHeader header_;
    State state_ = State::Opened;
    std::uint64_t n_vertices_ = 0;
    std::uint64_t n_triangles_ = 0;
    bool has_points_ = false;  // instead of vertices
};

/// The buffer of OutputFile, the block, and what the allocator adds.
constexpr std::uint64_t kFileSinkBytes = (1 << 20) + (128 << 10);

}  // namespace hewer::streaming
