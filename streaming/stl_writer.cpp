// SPDX-License-Identifier: MIT
#include "streaming/stl_writer.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hewer/error.h"
#include "hewer/version.h"
#include "ooc/units.h"
#include "streaming/file_sink.h"
#include "streaming/position_precision.h"
#include "streaming/put_bytes.h"

namespace hewer::streaming {

namespace {

using Point = std::array<float, 3>;

constexpr std::uint64_t kMostTriangles = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kTextBytes = 80;
constexpr std::size_t kFacetBytes = 50;

Point unit_normal(const Point& a, const Point& b, const Point& c) {
    Vec3 u{}, v{};
    for (std::size_t i = 0; i < 3; ++i) {
        u[i] = static_cast<double>(b[i]) - static_cast<double>(a[i]);
        v[i] = static_cast<double>(c[i]) - static_cast<double>(a[i]);
    }
    const Vec3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    // Products of differences of floats: their squares neither overflow nor vanish in double.
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return {0, 0, 0};
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
            static_cast<float>(n[2] / length)};
}

Point to_point(const Vec3& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

char* put_facet(char* out, const std::array<Point, 3>& corners) {
    for (const float x : unit_normal(corners[0], corners[1], corners[2])) out = put_bytes(out, x);
    for (const Point& p : corners) {
        for (const float x : p) out = put_bytes(out, x);
    }
    return put_bytes(out, std::uint16_t{0});  // "attribute byte count"
}

class StlWriter final : public FileSink {
  public:
    StlWriter(const std::filesystem::path& path, bool overwrite) : FileSink(path, overwrite) {}

  private:
    void write_header() override {
        require_stl_fits(path(), header());
        // Readers take a file that begins with "solid" for text.
        std::string text = "binary STL written by hewer " + std::string(version());
        text.resize(kTextBytes, ' ');
        file().write(text);
        const auto count = static_cast<std::uint32_t>(header().n_triangles);
        std::array<char, sizeof count> bytes{};
        put_bytes(bytes.data(), count);
        file().write(bytes.data(), bytes.size());
    }

    void write_vertices(const VertexSpan& v) override {
        points_.reserve(header().n_vertices);
        for (const Vec3& p : v.positions) points_.push_back(to_point(p));
    }

    void write_triangles(std::span<const Triangle> triangles) override {
        write_records(triangles.size(), kFacetBytes, [&](std::size_t i, char* out) {
            const Triangle& t = triangles[i];
            return put_facet(out, {points_[t[0]], points_[t[1]], points_[t[2]]});
        });
    }

    [[nodiscard]] bool takes_points() const override { return true; }

    void write_points(std::span<const std::array<Vec3, 3>> triangles) override {
        write_records(triangles.size(), kFacetBytes, [&](std::size_t i, char* out) {
            const auto& t = triangles[i];
            return put_facet(out, {to_point(t[0]), to_point(t[1]), to_point(t[2])});
        });
    }

    std::vector<Point> points_;  // unless the triangles come as points
};

}  // namespace

void require_stl_fits(const std::filesystem::path& path, const SinkHeader& header) {
    if (header.n_triangles > kMostTriangles) {
        throw InvalidArgument(path.string() + ": " + ooc::format_count(header.n_triangles) +
                              " triangles; STL has a 32-bit count and ends at " +
                              ooc::format_count(kMostTriangles) + "; write .ply instead");
    }
    require_float_range(header.bounds, path, "STL");
}

std::unique_ptr<FileSink> create_stl(const std::filesystem::path& path,
                                     const MeshFileOptions& options) {
    return std::make_unique<StlWriter>(path, options.overwrite);
}

}  // namespace hewer::streaming
