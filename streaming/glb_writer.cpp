// SPDX-License-Identifier: MIT
#include "streaming/glb_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/file_sink.h"
#include "streaming/glb_document.h"
#include "streaming/position_precision.h"
#include "streaming/put_bytes.h"

namespace hewer::streaming {

namespace {

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"
constexpr std::uint64_t kFileHeaderBytes = 12;
constexpr std::uint64_t kChunkHeaderBytes = 8;
constexpr std::uint64_t kBinaryOffset =
    kFileHeaderBytes + kChunkHeaderBytes + kGlbDocumentBytes + kChunkHeaderBytes;
static_assert(kGlbDocumentBytes % 4 == 0, "chunks begin at multiples of four");
constexpr std::uint64_t kMostFileBytes = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kLargestVertexBytes = 12 + 12 + 8;
constexpr std::size_t kTriangleBytes = 12;
constexpr std::uint16_t kOpaque = 65535;

/// Linear light for every 16-bit value of sRGB (IEC 61966-2-1).
std::vector<std::uint16_t> make_linear_table() {
    std::vector<std::uint16_t> table(65536);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double c = static_cast<double>(i) / 65535;
        const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        table[i] = static_cast<std::uint16_t>(std::lround(linear * 65535));
    }
    return table;
}

std::array<float, 3> unit(const std::array<float, 3>& n) {
    const double x = static_cast<double>(n[0]);
    const double y = static_cast<double>(n[1]);
    const double z = static_cast<double>(n[2]);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (!(length > 0) || !std::isfinite(length)) return {0, 0, 1};
    return {static_cast<float>(x / length), static_cast<float>(y / length),
            static_cast<float>(z / length)};
}

GlbLayout layout_of(const SinkHeader& header) {
    GlbLayout layout;
    layout.n_vertices = header.n_vertices;
    layout.n_triangles = header.n_triangles;
    layout.has_normals = header.has_normals;
    layout.has_colors = header.has_colors;
    return layout;
}

std::uint64_t padded_binary_bytes(const GlbLayout& layout) {
    return (layout.binary_bytes() + 3) / 4 * 4;
}

class GlbWriter final : public FileSink {
  public:
    GlbWriter(const std::filesystem::path& path, bool overwrite) : FileSink(path, overwrite) {}

  private:
    void write_header() override {
        const SinkHeader& h = header();
        require_glb_fits(path(), h);
        layout_ = layout_of(h);
        if (float_is_too_coarse(h.bounds)) layout_.translation = local_origin(h.bounds);
        layout_.min.fill(std::numeric_limits<float>::infinity());
        layout_.max.fill(-std::numeric_limits<float>::infinity());
        if (h.has_colors) linear_ = make_linear_table();
        file().write(std::string(kBinaryOffset, ' '));  // filled in by write_end()
    }

    void write_vertices(const VertexSpan& v) override {
        write_records(v.positions.size(), kLargestVertexBytes, [&](std::size_t i, char* out) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto x = static_cast<float>(v.positions[i][axis] - layout_.translation[axis]);
                layout_.min[axis] = std::min(layout_.min[axis], x);
                layout_.max[axis] = std::max(layout_.max[axis], x);
                out = put_bytes(out, x);
            }
            if (layout_.has_normals) {
                for (const float x : unit(v.normals[i])) out = put_bytes(out, x);
            }
            if (layout_.has_colors) {
                const Rgba16& color = v.colors[i];
                for (std::size_t c = 0; c < 3; ++c) out = put_bytes(out, linear_[color[c]]);
                const std::uint16_t alpha = header().has_alpha ? color[3] : kOpaque;
                layout_.has_transparency |= alpha < kOpaque;
                out = put_bytes(out, alpha);
            }
            return out;
        });
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        const bool is_short = layout_.has_short_indices();
        write_records(triangles.size(), kTriangleBytes, [&](std::size_t i, char* out) {
            for (const std::uint64_t id : triangles[i]) {
                out = is_short ? put_bytes(out, static_cast<std::uint16_t>(id))
                               : put_bytes(out, static_cast<std::uint32_t>(id));
            }
            return out;
        });
    }

    void write_end() override {
        const std::string padding(padded_binary_bytes(layout_) - layout_.binary_bytes(), '\0');
        file().write(padding);

        std::string document = glb_document(layout_);
        document.resize(kGlbDocumentBytes, ' ');
        std::array<char, kBinaryOffset> front{};
        char* out = front.data();
        const auto put = [&](std::uint64_t value) {
            out = put_bytes(out, static_cast<std::uint32_t>(value));
        };
        put(kMagic);
        put(2);
        put(kBinaryOffset + padded_binary_bytes(layout_));
        put(kGlbDocumentBytes);
        put(kJsonChunk);
        out = std::copy(document.begin(), document.end(), out);
        put(padded_binary_bytes(layout_));
        put(kBinChunk);
        file().write_at(0, front.data(), front.size());
    }

    GlbLayout layout_;
    std::vector<std::uint16_t> linear_;
};

}  // namespace

void require_glb_fits(const std::filesystem::path& path, const SinkHeader& header) {
    if (header.n_vertices == 0 || header.n_triangles == 0) {
        throw InvalidArgument(path.string() +
                              ": glTF cannot hold a mesh without triangles; write .ply instead");
    }
    // The counts first: their product must not wrap.
    if (std::max(header.n_vertices, header.n_triangles) > kMostFileBytes ||
        kBinaryOffset + padded_binary_bytes(layout_of(header)) > kMostFileBytes) {
        throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_vertices) +
                              " vertices and " + ooc::format_count(header.n_triangles) +
                              " triangles do not fit in a GLB file, which ends at 4 GiB; write "
                              ".ply instead, or ask for fewer triangles");
    }
    require_float_range(header.bounds, path, "glTF");
}

std::unique_ptr<FileSink> create_glb(const std::filesystem::path& path, bool overwrite) {
    return std::make_unique<GlbWriter>(path, overwrite);
}

}  // namespace hewer::streaming
