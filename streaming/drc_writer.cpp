// SPDX-License-Identifier: MIT
#include "streaming/drc_writer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hewer/error.h"
#include "ooc/units.h"
#include "streaming/draco_encoder.h"
#include "streaming/position_precision.h"
#include "streaming/quantization.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kMostElements = std::uint64_t{1} << 31;

class DrcWriter final : public FileSink {
  public:
    DrcWriter(const std::filesystem::path& path, const MeshFileOptions& options)
        : FileSink(path, options.overwrite), wanted_(options.quantization) {
        if (wanted_.kind == Quantization::Kind::None) wanted_.kind = Quantization::Kind::Auto;
    }
    [[nodiscard]] std::uint64_t held_bytes(const SinkHeader& header) const override {
        return DracoEncoder::bytes(header);
    }
    [[nodiscard]] double displacement() const override { return displacement_; }

  private:
    void write_header() override {
        require_drc_fits(path(), header());
        encoder_.emplace(header(), Vec3{});
    }
    void write_vertices(const VertexSpan& v) override { encoder_->add_vertices(v); }
    void write_triangles(std::span<const Triangle> triangles) override {
        encoder_->add_triangles(triangles);
    }
    void write_end() override {
        const double step = wanted_step(wanted_, header());
        const unsigned bits = step > 0 ? bits_for(step, header().bounds) : 0;
        if (bits > 0) displacement_ = std::sqrt(3) / 2 * step_of(bits, header().bounds);
        const DracoEncoder::Encoded encoded = encoder_->encode(bits);
        file().write(encoded.bytes.data(), encoded.bytes.size());
    }

    Quantization wanted_;
    std::optional<DracoEncoder> encoder_;
    double displacement_ = 0;
};

}  // namespace

void require_drc_fits(const std::filesystem::path& path, const SinkHeader& header) {
    if (header.n_vertices == 0 || header.n_triangles == 0) {
        throw InvalidArgument(path.string() +
                              ": Draco cannot hold a mesh without triangles; write .ply instead");
    }
    if (std::max(header.n_vertices, header.n_triangles) >= kMostElements) {
        throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_triangles) +
                              " triangles; Draco ends at 2^31; write .ply instead");
    }
    require_float_range(header.bounds, path, "Draco");
}

std::unique_ptr<FileSink> create_drc(const std::filesystem::path& path,
                                     const MeshFileOptions& options) {
    return std::make_unique<DrcWriter>(path, options);
}

}  // namespace hewer::streaming
