// SPDX-License-Identifier: MIT
#include "streaming/gltf_writer.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/draco_encoder.h"
#include "streaming/file_sink.h"
#include "streaming/gltf_text.h"
#include "streaming/position_precision.h"
#include "streaming/put_bytes.h"
#include "streaming/quantization.h"

namespace hewer::streaming {

namespace {

constexpr std::uint32_t kMagic = 0x46546C67;      // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"
constexpr std::uint64_t kFileHeaderBytes = 12;
constexpr std::uint64_t kChunkHeaderBytes = 8;
constexpr std::uint64_t kBinaryOffset =
    kFileHeaderBytes + kChunkHeaderBytes + kGltfTextBytes + kChunkHeaderBytes;
static_assert(kGltfTextBytes % 4 == 0, "chunks begin at multiples of four");
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

constexpr std::uint64_t padded(std::uint64_t bytes) {
    return (bytes + 3) / 4 * 4;
}

GltfLayout layout_of(const SinkHeader& header) {
    GltfLayout layout;
    layout.n_vertices = header.n_vertices;
    layout.n_triangles = header.n_triangles;
    layout.has_normals = header.has_normals;
    layout.has_colors = header.has_colors;
    return layout;
}

/// A file name as a URI: what is not plain is percent-encoded.
std::string uri_of(const std::string& name) {
    constexpr std::string_view kPlain = "-_.~";
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string uri;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                              (c >= 'A' && c <= 'Z') || kPlain.find(c) != kPlain.npos;
        if (is_plain) {
            uri += c;
        } else {
            uri += '%';
            uri += kDigits[byte >> 4];
            uri += kDigits[byte & 15U];
        }
    }
    return uri;
}

class GltfWriter final : public FileSink {
  public:
    GltfWriter(const std::filesystem::path& path, const MeshFileOptions& options, bool is_glb)
        : FileSink(path, options.overwrite), wanted_(options.quantization) {
        layout_.compression = options.compression;
        if (!is_glb) {
            std::filesystem::path bin = path;
            bin.replace_extension(".bin");
            bin_.emplace(bin, options.overwrite);
        }
        const bool is_draco = options.compression == Compression::Draco;
        if (is_draco && wanted_.kind == Quantization::Kind::None) {
            wanted_.kind = Quantization::Kind::Auto;
        }
    }

    void publish_with(ooc::OutputGroup& group) override {
        if (bin_) bin_->publish_with(group);
        FileSink::publish_with(group);
    }
    [[nodiscard]] std::uint64_t bytes_written() const override {
        return FileSink::bytes_written() + (bin_ ? bin_->bytes_written() : 0);
    }
    [[nodiscard]] std::uint64_t held_bytes(const SinkHeader& header) const override {
        switch (layout_.compression) {
            case Compression::None:
                break;
            case Compression::Meshopt:
                return 2 * layout_of(header).plain_bytes() + 6 * header.n_triangles;
            case Compression::Draco:
                return DracoEncoder::bytes(header);
        }
        return 0;
    }
    [[nodiscard]] double displacement() const override { return displacement_; }

  private:
    void write_header() override {
        const SinkHeader& h = header();
        const Compression compression = layout_.compression;
        layout_ = layout_of(h);
        layout_.compression = compression;
        if (bin_) {
            require_gltf_fits(path(), h);
            layout_.uri = uri_of(bin_->path().filename().string());
        } else {
            require_glb_fits(path(), h);
        }
        choose_quantization();
        layout_.min.fill(std::numeric_limits<double>::infinity());
        layout_.max.fill(-std::numeric_limits<double>::infinity());
        if (h.has_colors) linear_ = make_linear_table();
        if (compression == Compression::Draco) encoder_.emplace(h, layout_.translation);
        if (compression == Compression::Meshopt) {
            vertices_.reserve(layout_.indices_offset());
            indices_.reserve(3 * h.n_triangles);
        }
        if (!bin_ && compression == Compression::None) {
            file().write(std::string(kBinaryOffset, ' '));  // filled in by write_end()
        }
    }

    void choose_quantization() {
        const Bounds& bounds = header().bounds;
        const double step = wanted_step(wanted_, header());
        const unsigned bits = step > 0 ? bits_for(step, bounds) : 0;
        if (float_is_too_coarse(bounds)) layout_.translation = local_origin(bounds);
        double used = 0;
        if (layout_.compression == Compression::Draco) {
            draco_bits_ = bits;
            if (bits > 0) used = step_of(bits, bounds);
        } else if (bits > 0 && bits <= kMostGltfBits) {
            // Uncompressed, all 16 bits: they are stored anyway.
            const bool is_packed = layout_.compression == Compression::Meshopt;
            used = step_of(is_packed ? bits : kMostGltfBits, bounds);
            layout_.step = used;
            layout_.translation = bounds.min;
        }
        displacement_ = std::sqrt(3) / 2 * used;
    }

    void write_vertices(const VertexSpan& v) override {
        switch (layout_.compression) {
            case Compression::None:
                write_records(v.positions.size(), kLargestVertexBytes,
                              [&](std::size_t i, char* out) { return put_vertex(v, i, out); });
                break;
            case Compression::Meshopt: {
                std::array<char, kLargestVertexBytes> record{};
                for (std::size_t i = 0; i < v.positions.size(); ++i) {
                    char* const end = put_vertex(v, i, record.data());
                    vertices_.insert(vertices_.end(), record.data(), end);
                }
                break;
            }
            case Compression::Draco:
                add_to_encoder(v);
                break;
        }
    }

    char* put_vertex(const VertexSpan& v, std::size_t i, char* out) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = v.positions[i][axis] - layout_.translation[axis];
            if (layout_.is_quantized()) {
                const double q = std::clamp(std::round(x / layout_.step), 0.0, 65535.0);
                extend(axis, q);
                out = put_bytes(out, static_cast<std::uint16_t>(q));
            } else {
                const auto single = static_cast<float>(x);
                extend(axis, static_cast<double>(single));
                out = put_bytes(out, single);
            }
        }
        if (layout_.is_quantized()) out = put_bytes(out, std::uint16_t{0});
        if (layout_.has_normals) {
            const std::array<float, 3> n = unit(v.normals[i]);
            if (layout_.is_quantized()) {
                for (const float x : n) {
                    out = put_bytes(out, static_cast<std::int8_t>(std::lround(127 * x)));
                }
                out = put_bytes(out, std::int8_t{0});
            } else {
                for (const float x : n) out = put_bytes(out, x);
            }
        }
        if (layout_.has_colors) {
            for (const std::uint16_t c : linear_color(v.colors[i])) out = put_bytes(out, c);
        }
        return out;
    }

    Rgba16 linear_color(const Rgba16& color) {
        const std::uint16_t alpha = header().has_alpha ? color[3] : kOpaque;
        layout_.has_transparency |= alpha < kOpaque;
        return {linear_[color[0]], linear_[color[1]], linear_[color[2]], alpha};
    }

    void extend(std::size_t axis, double x) {
        layout_.min[axis] = std::min(layout_.min[axis], x);
        layout_.max[axis] = std::max(layout_.max[axis], x);
    }

    void add_to_encoder(const VertexSpan& v) {
        std::vector<std::array<float, 3>> normals;
        std::vector<Rgba16> colors;
        for (std::size_t i = 0; i < v.positions.size(); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                extend(axis, static_cast<double>(static_cast<float>(v.positions[i][axis] -
                                                                    layout_.translation[axis])));
            }
            if (layout_.has_normals) normals.push_back(unit(v.normals[i]));
            if (layout_.has_colors) colors.push_back(linear_color(v.colors[i]));
        }
        encoder_->add_vertices({v.positions, normals, colors});
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        if (encoder_) {
            encoder_->add_triangles(triangles);
            return;
        }
        if (layout_.compression == Compression::Meshopt) {
            for (const Triangle& t : triangles) {
                for (const std::uint64_t id : t) indices_.push_back(static_cast<std::uint32_t>(id));
            }
            return;
        }
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
        std::vector<char> packed;
        if (layout_.compression == Compression::Meshopt) packed = pack();
        if (encoder_) packed = encode();
        if (bin_) {
            bin_->write(packed.data(), packed.size());
            bin_->commit();
            file().write(gltf_text(layout_));
            return;
        }
        std::string document = gltf_text(layout_);
        if (layout_.compression == Compression::None) {
            document.resize(kGltfTextBytes, ' ');
            file().write(std::string(padded(layout_.plain_bytes()) - layout_.plain_bytes(), '\0'));
            const std::string front = front_of(document, layout_.plain_bytes());
            file().write_at(0, front.data(), front.size());
            return;
        }
        document.resize(padded(document.size()), ' ');
        packed.resize(padded(packed.size()));
        file().write(front_of(document, packed.size()));
        file().write(packed.data(), packed.size());
    }

    /// Everything of a GLB before the bytes of its binary chunk.
    static std::string front_of(const std::string& document, std::uint64_t binary_bytes) {
        std::array<char, 2 * kChunkHeaderBytes + kFileHeaderBytes> words{};
        char* out = words.data();
        const auto put = [&](std::uint64_t value) {
            out = put_bytes(out, static_cast<std::uint32_t>(value));
        };
        put(kMagic);
        put(2);
        put(words.size() + document.size() + padded(binary_bytes));
        put(document.size());
        put(kJsonChunk);
        put(padded(binary_bytes));
        put(kBinChunk);
        const std::string_view all(words.data(), words.size());
        const std::size_t before = kFileHeaderBytes + kChunkHeaderBytes;
        return std::string(all.substr(0, before)) + document + std::string(all.substr(before));
    }

    std::vector<char> pack() {
        const std::uint64_t stride = layout_.vertex_bytes();
        std::vector<char> packed(
            meshopt_encodeVertexBufferBound(layout_.n_vertices, stride) + 3 +
            meshopt_encodeIndexBufferBound(indices_.size(), layout_.n_vertices));
        const auto at = [&](std::uint64_t offset) {
            return reinterpret_cast<unsigned char*>(packed.data() + offset);
        };
        layout_.packed_vertices.bytes = meshopt_encodeVertexBuffer(
            at(0), packed.size(), vertices_.data(), layout_.n_vertices, stride);
        const std::uint64_t offset = padded(layout_.packed_vertices.bytes);
        layout_.packed_indices = {
            offset, meshopt_encodeIndexBuffer(at(offset), packed.size() - offset, indices_.data(),
                                              indices_.size())};
        if (layout_.packed_vertices.bytes == 0 || layout_.packed_indices.bytes == 0) {
            throw InternalError("meshoptimizer does not encode the mesh");
        }
        packed.resize(offset + layout_.packed_indices.bytes);
        return packed;
    }

    std::vector<char> encode() {
        DracoEncoder::Encoded encoded = encoder_->encode(draco_bits_);
        if (draco_bits_ > 0) {
            // What the decoder will give: multiples of the step, from the least coordinate on.
            const double step = step_of(draco_bits_, header().bounds);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double n = std::ceil((layout_.max[axis] - layout_.min[axis]) / step);
                layout_.max[axis] =
                    static_cast<double>(static_cast<float>(layout_.min[axis] + n * step));
            }
        }
        layout_.n_vertices = encoded.n_points;
        layout_.n_triangles = encoded.n_faces;
        layout_.packed_vertices.bytes = encoded.bytes.size();
        layout_.position_id = encoded.position_id;
        layout_.normal_id = encoded.normal_id;
        layout_.color_id = encoded.color_id;
        return std::move(encoded.bytes);
    }

    ooc::OutputFile& data() override { return bin_ ? *bin_ : file(); }

    Quantization wanted_;
    GltfLayout layout_;
    std::optional<ooc::OutputFile> bin_;  // none: GLB
    std::vector<std::uint16_t> linear_;
    double displacement_ = 0;
    // Compressed by meshopt.
    std::vector<char> vertices_;
    std::vector<std::uint32_t> indices_;
    // Compressed by Draco.
    std::optional<DracoEncoder> encoder_;
    unsigned draco_bits_ = 0;
};

}  // namespace

void require_gltf_fits(const std::filesystem::path& path, const SinkHeader& header) {
    if (header.n_vertices == 0 || header.n_triangles == 0) {
        throw InvalidArgument(path.string() +
                              ": glTF cannot hold a mesh without triangles; write .ply instead");
    }
    if (header.n_vertices > std::numeric_limits<std::uint32_t>::max()) {
        throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_vertices) +
                              " vertices; glTF has 32-bit indices; write .obj instead");
    }
    require_float_range(header.bounds, path, "glTF");
}

void require_glb_fits(const std::filesystem::path& path, const SinkHeader& header) {
    // The counts first: their product must not wrap.
    if (std::max(header.n_vertices, header.n_triangles) > kMostFileBytes ||
        kBinaryOffset + padded(layout_of(header).plain_bytes()) > kMostFileBytes) {
        throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_vertices) +
                              " vertices and " + ooc::format_count(header.n_triangles) +
                              " triangles do not fit in a GLB file, which ends at 4 GiB; write "
                              ".gltf or .ply instead, or ask for fewer triangles");
    }
    require_gltf_fits(path, header);
}

std::unique_ptr<FileSink> create_gltf(const std::filesystem::path& path,
                                      const MeshFileOptions& options) {
    const bool is_glb = path.extension().string().size() == 4;  // not .gltf
    return std::make_unique<GltfWriter>(path, options, is_glb);
}

}  // namespace hewer::streaming
