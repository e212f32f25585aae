// SPDX-License-Identifier: MIT
#include "streaming/off_writer.h"

#include <string>

#include "hewer/version.h"
#include "streaming/position_precision.h"
#include "streaming/put_bytes.h"
#include "streaming/put_text.h"

namespace hewer::streaming {

namespace {

constexpr std::size_t kVertexBytes = 6 * kNumberBytes + 4 * 4 + 1;
constexpr std::size_t kFaceBytes = 1 + 3 * (1 + kIdBytes) + 1;

class OffWriter final : public FileSink {
  public:
    OffWriter(const std::filesystem::path& path, bool overwrite) : FileSink(path, overwrite) {}

  private:
    void write_header() override {
        const SinkHeader& h = header();
        is_double_ = needs_double(h);
        file().write(std::string(h.has_colors ? "C" : "") + (h.has_normals ? "N" : "") +
                     "OFF\n# written by hewer " + std::string(version()) + "\n" +
                     std::to_string(h.n_vertices) + " " + std::to_string(h.n_triangles) + " 0\n");
    }

    void write_vertices(const VertexSpan& v) override {
        const SinkHeader& h = header();
        write_records(v.positions.size(), kVertexBytes, [&](std::size_t i, char* const begin) {
            char* out = begin;
            for (const double x : v.positions[i]) {
                out = is_double_ ? put_number(out, x) : put_number(out, static_cast<float>(x));
            }
            if (h.has_normals) {
                for (const float x : v.normals[i]) out = put_number(out, x);
            }
            if (h.has_colors) {
                for (std::size_t c = 0; c < 4; ++c) {
                    const std::uint16_t value = c < 3 || h.has_alpha ? v.colors[i][c] : 65535;
                    *out++ = ' ';
                    out = put_id(out, to_8_bits(value));
                }
            }
            *out++ = '\n';
            return std::copy(begin + 1, out, begin);  // without the first blank
        });
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        write_records(triangles.size(), kFaceBytes, [&](std::size_t i, char* out) {
            *out++ = '3';
            for (const std::uint64_t id : triangles[i]) {
                *out++ = ' ';
                out = put_id(out, id);
            }
            *out++ = '\n';
            return out;
        });
    }

    bool is_double_ = false;
};

}  // namespace

std::unique_ptr<FileSink> create_off(const std::filesystem::path& path,
                                     const MeshFileOptions& options) {
    return std::make_unique<OffWriter>(path, options.overwrite);
}

}  // namespace hewer::streaming
