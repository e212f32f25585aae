// SPDX-License-Identifier: MIT
#include "streaming/obj_writer.h"

#include <string>

#include "hewer/version.h"
#include "streaming/file_sink.h"
#include "streaming/position_precision.h"
#include "streaming/put_text.h"

namespace hewer::streaming {

namespace {

// "v", three coordinates, three colours, a line end; "vn", three components, a line end.
constexpr std::size_t kVertexBytes = 2 * (3 + 6 * kNumberBytes);
// "f", three times "id//id".
constexpr std::size_t kFaceBytes = 3 + 3 * (2 * kIdBytes + 3);

/// " " and v / 65535 in five digits, trailing zeros left out.
char* put_channel(char* out, std::uint16_t v) {
    std::uint64_t digits = (v * 100'000ULL + 32'767) / 65'535;
    *out++ = ' ';
    if (digits == 100'000) {
        *out++ = '1';
        return out;
    }
    *out++ = '0';
    if (digits == 0) return out;
    *out++ = '.';
    for (std::uint64_t unit = 10'000; digits > 0; unit /= 10) {
        *out++ = static_cast<char>('0' + digits / unit);
        digits %= unit;
    }
    return out;
}

class ObjWriter final : public FileSink {
  public:
    ObjWriter(const std::filesystem::path& path, bool overwrite) : FileSink(path, overwrite) {}

  private:
    void write_header() override {
        is_double_ = needs_double(header());
        file().write("# written by hewer " + std::string(version()) + "\n# " +
                     std::to_string(header().n_vertices) + " vertices, " +
                     std::to_string(header().n_triangles) + " triangles\n");
    }

    void write_vertices(const VertexSpan& v) override {
        const SinkHeader& h = header();
        write_records(v.positions.size(), kVertexBytes, [&](std::size_t i, char* out) {
            *out++ = 'v';
            for (const double x : v.positions[i]) {
                out = is_double_ ? put_number(out, x) : put_number(out, static_cast<float>(x));
            }
            if (h.has_colors) {
                for (std::size_t c = 0; c < 3; ++c) out = put_channel(out, v.colors[i][c]);
            }
            *out++ = '\n';
            if (h.has_normals) {
                *out++ = 'v';
                *out++ = 'n';
                for (const float x : v.normals[i]) out = put_number(out, x);
                *out++ = '\n';
            }
            return out;
        });
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        const bool has_normals = header().has_normals;
        write_records(triangles.size(), kFaceBytes, [&](std::size_t i, char* out) {
            *out++ = 'f';
            for (const std::uint64_t id : triangles[i]) {
                *out++ = ' ';
                out = put_id(out, id + 1);  // OBJ counts from 1
                if (has_normals) {
                    *out++ = '/';
                    *out++ = '/';
                    out = put_id(out, id + 1);
                }
            }
            *out++ = '\n';
            return out;
        });
    }

    bool is_double_ = false;
};

}  // namespace

std::unique_ptr<FileSink> create_obj(const std::filesystem::path& path,
                                     const MeshFileOptions& options) {
    return std::make_unique<ObjWriter>(path, options.overwrite);
}

}  // namespace hewer::streaming
