// SPDX-License-Identifier: MIT
#include "streaming/ply_writer.h"

#include <algorithm>
#include <string>

#include "hewer/error.h"
#include "hewer/version.h"
#include "ooc/units.h"
#include "streaming/file_sink.h"
#include "streaming/position_precision.h"
#include "streaming/put_bytes.h"
#include "streaming/put_text.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kMostVertices = 1ULL << 32;
constexpr std::uint64_t kMostSignedVertices = 1ULL << 31;
constexpr std::size_t kLargestVertexBytes = 3 * 8 + 3 * 4 + 4;
constexpr std::size_t kFaceBytes = 1 + 3 * 4;
constexpr std::size_t kVertexTextBytes = 6 * kNumberBytes + 4 * 4 + 1;
constexpr std::size_t kFaceTextBytes = 1 + 3 * (1 + kIdBytes) + 1;

/// What both encodings have in common: the header.
class PlyWriter : public FileSink {
  protected:
    PlyWriter(const std::filesystem::path& path, const MeshFileOptions& options)
        : FileSink(path, options.overwrite), is_ascii_(options.is_ascii) {}

    [[nodiscard]] bool is_double() const { return is_double_; }
    [[nodiscard]] std::size_t n_channels() const {
        const SinkHeader& h = header();
        return !h.has_colors ? 0 : h.has_alpha ? 4 : 3;
    }

  private:
    void write_header() override {
        const SinkHeader& h = header();
        require_ply_fits(path(), h);
        is_double_ = needs_double(h);
        const std::string number = is_double_ ? "double" : "float";
        std::string text = "ply\nformat ";
        text += is_ascii_ ? "ascii 1.0\n" : "binary_little_endian 1.0\n";
        text += "comment written by hewer " + std::string(version()) + "\n";
        text += "element vertex " + std::to_string(h.n_vertices) + "\n";
        for (const char* name : {"x", "y", "z"}) text += "property " + number + " " + name + "\n";
        if (h.has_normals) text += "property float nx\nproperty float ny\nproperty float nz\n";
        if (h.has_colors) {
            text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
            if (h.has_alpha) text += "property uchar alpha\n";
        }
        text += "element face " + std::to_string(h.n_triangles) + "\n";
        text += h.n_vertices > kMostSignedVertices ? "property list uchar uint vertex_indices\n"
                                                   : "property list uchar int vertex_indices\n";
        text += "end_header\n";
        file().write(text);
    }

    bool is_ascii_;
    bool is_double_ = false;
};

class BinaryPlyWriter final : public PlyWriter {
  public:
    BinaryPlyWriter(const std::filesystem::path& path, const MeshFileOptions& options)
        : PlyWriter(path, options) {}

  private:
    void write_vertices(const VertexSpan& v) override {
        write_records(v.positions.size(), kLargestVertexBytes, [&](std::size_t i, char* out) {
            for (const double x : v.positions[i]) {
                out = is_double() ? put_bytes(out, x) : put_bytes(out, static_cast<float>(x));
            }
            if (header().has_normals) {
                for (const float x : v.normals[i]) out = put_bytes(out, x);
            }
            for (std::size_t c = 0; c < n_channels(); ++c) {
                out = put_bytes(out, to_8_bits(v.colors[i][c]));
            }
            return out;
        });
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        write_records(triangles.size(), kFaceBytes, [&](std::size_t i, char* out) {
            out = put_bytes(out, std::uint8_t{3});
            // The same bytes whether the header calls them int or uint.
            for (const std::uint64_t id : triangles[i]) {
                out = put_bytes(out, static_cast<std::uint32_t>(id));
            }
            return out;
        });
    }
};

class AsciiPlyWriter final : public PlyWriter {
  public:
    AsciiPlyWriter(const std::filesystem::path& path, const MeshFileOptions& options)
        : PlyWriter(path, options) {}

  private:
    void write_vertices(const VertexSpan& v) override {
        write_records(v.positions.size(), kVertexTextBytes, [&](std::size_t i, char* const begin) {
            char* out = begin;
            for (const double x : v.positions[i]) {
                out = is_double() ? put_number(out, x) : put_number(out, static_cast<float>(x));
            }
            if (header().has_normals) {
                for (const float x : v.normals[i]) out = put_number(out, x);
            }
            for (std::size_t c = 0; c < n_channels(); ++c) {
                *out++ = ' ';
                out = put_id(out, to_8_bits(v.colors[i][c]));
            }
            *out++ = '\n';
            return std::copy(begin + 1, out, begin);  // without the first blank
        });
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        write_records(triangles.size(), kFaceTextBytes, [&](std::size_t i, char* out) {
            *out++ = '3';
            for (const std::uint64_t id : triangles[i]) {
                *out++ = ' ';
                out = put_id(out, id);
            }
            *out++ = '\n';
            return out;
        });
    }
};

}  // namespace

void require_ply_fits(const std::filesystem::path& path, const SinkHeader& header) {
    if (header.n_vertices <= kMostVertices) return;
    throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_vertices) +
                          " vertices; PLY has 32-bit indices and ends at " +
                          ooc::format_count(kMostVertices) + "; write .obj instead");
}

std::unique_ptr<FileSink> create_ply(const std::filesystem::path& path,
                                     const MeshFileOptions& options) {
    if (options.is_ascii) return std::make_unique<AsciiPlyWriter>(path, options);
    return std::make_unique<BinaryPlyWriter>(path, options);
}

}  // namespace hewer::streaming
