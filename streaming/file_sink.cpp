// SPDX-License-Identifier: MIT
#include "streaming/file_sink.h"

#include <algorithm>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

std::string of(std::uint64_t count, std::uint64_t announced, const char* what) {
    return ooc::format_count(count) + " of " + ooc::format_count(announced) + " announced " + what;
}

}  // namespace

FileSink::FileSink(const std::filesystem::path& path, bool overwrite)
    : file_(path, overwrite), block_(kBlockBytes) {}

void FileSink::require(bool holds, const std::string& what) const {
    if (!holds) throw InternalError(path().string() + ": writer misused: " + what);
}

void FileSink::begin(const SinkHeader& header) {
    require(state_ == State::Opened, "begin() called twice");
    header_ = header;
    state_ = State::Begun;
    write_header();
}

void FileSink::add_vertices(const VertexSpan& vertices) {
    const std::size_t n = vertices.positions.size();
    require(state_ == State::Begun, "vertices outside begin() and finish()");
    require(!has_points_, "vertices after triangles that are points");
    if (n > header_.n_vertices - n_vertices_) {
        require(false, of(n_vertices_ + n, header_.n_vertices, "vertices"));
    }
    require(!header_.has_normals || vertices.normals.size() == n, "vertices without their normals");
    require(!header_.has_colors || vertices.colors.size() == n, "vertices without their colours");
    n_vertices_ += n;
    write_vertices(vertices);
}

void FileSink::add_triangles(std::span<const Triangle> triangles) {
    require(state_ == State::Begun, "triangles outside begin() and finish()");
    if (n_vertices_ != header_.n_vertices) {
        require(false, "triangles after " + of(n_vertices_, header_.n_vertices, "vertices"));
    }
    for (const Triangle& t : triangles) {
        const std::uint64_t largest = std::max({t[0], t[1], t[2]});
        if (largest >= n_vertices_) {
            require(false, "a triangle refers to vertex " + ooc::format_count(largest) + " of " +
                               ooc::format_count(n_vertices_));
        }
    }
    count_triangles(triangles.size());
    write_triangles(triangles);
}

void FileSink::add_points(std::span<const std::array<Vec3, 3>> triangles) {
    require(takes_points(), "triangles as points");
    require(state_ == State::Begun, "triangles outside begin() and finish()");
    require(n_vertices_ == 0, "triangles as points after vertices");
    has_points_ = true;
    count_triangles(triangles.size());
    write_points(triangles);
}

void FileSink::write_points(std::span<const std::array<Vec3, 3>> triangles) {
    MeshSink::add_points(triangles);
}

void FileSink::count_triangles(std::size_t n) {
    if (n > header_.n_triangles - n_triangles_) {
        require(false, of(n_triangles_ + n, header_.n_triangles, "triangles"));
    }
    n_triangles_ += n;
}

void FileSink::finish() {
    require(state_ == State::Begun, "finish() without begin()");
    if (!has_points_ && n_vertices_ != header_.n_vertices) {
        require(false, "finish() after " + of(n_vertices_, header_.n_vertices, "vertices"));
    }
    if (n_triangles_ != header_.n_triangles) {
        require(false, "finish() after " + of(n_triangles_, header_.n_triangles, "triangles"));
    }
    state_ = State::Finished;
    write_end();
    file_.commit();
}

}  // namespace hewer::streaming
