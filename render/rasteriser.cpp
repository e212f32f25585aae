// SPDX-License-Identifier: MIT
#include "render/rasteriser.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace hewer::raster {

namespace {

constexpr unsigned kSide = 2;  // samples along a pixel's side

// Shares of light; what faces the key light and the sky at once gets a little over 1.
constexpr double kKey = 0.74;
constexpr double kSky = 0.22;
constexpr double kAround = 0.18;

// Edge lines: half their width in samples; a triangle flatter than kEdgeFade of these gets fainter
// lines, so that fine meshes do not go black.
constexpr double kHalfLine = 0.9;
constexpr double kEdgeFade = 8;
constexpr double kEdgeDarkness = 0.75;

double dot(const Vec3& a, const Vec3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vec3 difference(const Vec3& a, const Vec3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vec3 blend(double a, const Vec3& u, double b, const Vec3& v, double c, const Vec3& w) {
    Vec3 out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = a * u[k] + b * v[k] + c * w[k];
    const double length = std::sqrt(dot(out, out));
    for (double& x : out) x /= length;
    return out;
}

/// At the place with edge functions `e`, which add up to `area`.
Color blend(const Rasteriser::Paint& colors, const std::array<double, 3>& e, double area) {
    Color color{};
    for (std::size_t k = 0; k < 3; ++k) {
        color[k] = static_cast<float>((e[0] * static_cast<double>(colors[0][k]) +
                                       e[1] * static_cast<double>(colors[1][k]) +
                                       e[2] * static_cast<double>(colors[2][k])) /
                                      area);
    }
    return color;
}

std::uint32_t pack(const Color& c, double light) {
    std::uint32_t packed = 0;
    for (const float channel : c) {
        const double v = std::clamp(static_cast<double>(channel) * light, 0.0, 1.0);
        packed = packed << 8 | static_cast<std::uint32_t>(std::lround(v * 255));
    }
    return packed;
}

}  // namespace

Rasteriser::Rasteriser(ooc::MemoryBudget& budget, unsigned width, unsigned height,
                       const Camera& camera, const Style& style)
    : width_(width),
      height_(height),
      camera_(camera),
      style_(style),
      key_light_(blend(-0.45, camera.right, 0.55, camera.up, 1, camera.toward)),
      sky_(blend(0, camera.right, 1, camera.up, 0.15, camera.toward)),
      scale_(camera.pixels_per_unit * kSide),
      samples_(budget, "picture samples", std::uint64_t{width} * height * kSide * kSide) {}

Rasteriser::Screen Rasteriser::project(const Vec3& p) const {
    return {0.5 * kSide * width_ + scale_ * dot(p, camera_.right),
            0.5 * kSide * height_ - scale_ * dot(p, camera_.up),
            std::clamp(0.5 - 0.5 * dot(p, camera_.toward) / camera_.depth_range, 0.0, 1.0)};
}

void Rasteriser::draw(const std::array<Vec3, 3>& corners, const Paint* paint) {
    std::array<Screen, 3> p{project(corners[0]), project(corners[1]), project(corners[2])};
    double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    if (!std::isfinite(area) || area == 0) return;
    Vec3 normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 0)) return;
    // Rows go down, so what is counter-clockwise for the viewer has negative area here.
    const bool is_front = area < 0;
    for (double& x : normal) x /= is_front ? length : -length;
    const double light = kAround + kKey * std::max(0.0, dot(normal, key_light_)) +
                         kSky * (0.5 + 0.5 * dot(normal, sky_));
    const Color& plain = is_front ? style_.front : style_.back;
    Paint colors{plain, plain, plain};
    if (is_front && paint != nullptr) colors = *paint;
    for (Color& color : colors) {
        for (float& channel : color) channel *= static_cast<float>(light);
    }
    if (is_front) {
        std::swap(p[1], p[2]);
        std::swap(colors[1], colors[2]);
        area = -area;
    }
    fill(p, area, colors);
}

void Rasteriser::fill(const std::array<Screen, 3>& p, double area, const Paint& colors) {
    const double columns = kSide * width_;
    const double rows = kSide * height_;
    // Sample i lies at i + 0.5.
    const double x_low = std::max(0.0, std::ceil(std::min({p[0].x, p[1].x, p[2].x}) - 0.5));
    const double y_low = std::max(0.0, std::ceil(std::min({p[0].y, p[1].y, p[2].y}) - 0.5));
    const double x_high =
        std::min(columns - 1, std::floor(std::max({p[0].x, p[1].x, p[2].x}) - 0.5));
    const double y_high = std::min(rows - 1, std::floor(std::max({p[0].y, p[1].y, p[2].y}) - 0.5));
    if (x_low > x_high || y_low > y_high) return;

    // Edge functions, e[k] opposite corner k; positive inside, |area| at the corner.
    std::array<double, 3> step_x{};
    std::array<double, 3> step_y{};
    std::array<double, 3> per_sample{};  // edge function to distance in samples
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Screen& a = p[(k + 1) % 3];
        const Screen& b = p[(k + 2) % 3];
        step_x[k] = a.y - b.y;
        step_y[k] = b.x - a.x;
        const double length = std::sqrt(step_x[k] * step_x[k] + step_y[k] * step_y[k]);
        per_sample[k] = 1 / length;
        longest = std::max(longest, length);
    }
    const bool is_plain = colors[0] == colors[1] && colors[0] == colors[2];
    const std::uint32_t plain = pack(colors[0], 1);
    double line_light = 1;
    if (style_.edges) {
        const double strength = std::min(1.0, area / longest / (kEdgeFade * kHalfLine));
        line_light = 1 - kEdgeDarkness * strength;
    }

    const auto x_first = static_cast<std::uint64_t>(x_low);
    const auto x_last = static_cast<std::uint64_t>(x_high);
    const auto y_last = static_cast<std::uint64_t>(y_high);
    for (auto y = static_cast<std::uint64_t>(y_low); y <= y_last; ++y) {
        for (std::uint64_t x = x_first; x <= x_last; ++x) {
            const double sx = static_cast<double>(x) + 0.5;
            const double sy = static_cast<double>(y) + 0.5;
            std::array<double, 3> e{};
            for (std::size_t k = 0; k < 3; ++k) {
                const Screen& a = p[(k + 1) % 3];
                e[k] = (sx - a.x) * step_x[k] + (sy - a.y) * step_y[k];
            }
            if (e[0] < 0 || e[1] < 0 || e[2] < 0) continue;
            const double depth = (e[0] * p[0].depth + e[1] * p[1].depth + e[2] * p[2].depth) / area;
            const bool is_line =
                style_.edges && std::min({e[0] * per_sample[0], e[1] * per_sample[1],
                                          e[2] * per_sample[2]}) < kHalfLine;
            std::uint32_t rgb = plain;
            if (!is_plain || is_line) {
                const Color color = is_plain ? colors[0] : blend(colors, e, area);
                rgb = pack(color, is_line ? line_light : 1);
            }
            const auto level =
                static_cast<std::uint32_t>(std::clamp(depth, 0.0, 1.0) * 4294967294.0);
            keep_nearest(y * kSide * width_ + x, std::uint64_t{level} << 32 | rgb);
        }
    }
}

void Rasteriser::keep_nearest(std::uint64_t index, std::uint64_t word) {
    const std::uint64_t inverted = ~word;
    std::atomic_ref<std::uint64_t> sample(samples_[index]);
    std::uint64_t now = sample.load(std::memory_order_relaxed);
    while (inverted > now &&
           !sample.compare_exchange_weak(now, inverted, std::memory_order_relaxed)) {
    }
}

void Rasteriser::resolve(std::span<std::uint8_t> pixels) const {
    std::size_t at = 0;
    for (std::uint64_t y = 0; y < height_; ++y) {
        const float down = (static_cast<float>(y) + 0.5F) / static_cast<float>(height_);
        Color ground{};
        for (std::size_t k = 0; k < 3; ++k) {
            ground[k] = style_.background_top[k] +
                        down * (style_.background_bottom[k] - style_.background_top[k]);
        }
        const std::uint32_t background = pack(ground, 1);
        for (std::uint64_t x = 0; x < width_; ++x) {
            std::array<std::uint32_t, 3> sum{};
            for (std::uint64_t s = 0; s < kSide * kSide; ++s) {
                const std::uint64_t row = y * kSide + s / kSide;
                const std::uint64_t stored = samples_[row * kSide * width_ + x * kSide + s % kSide];
                const std::uint32_t rgb =
                    stored == 0 ? background : static_cast<std::uint32_t>(~stored);
                for (unsigned k = 0; k < 3; ++k) sum[k] += rgb >> (16 - 8 * k) & 0xff;
            }
            for (const std::uint32_t s : sum) {
                pixels[at++] = static_cast<std::uint8_t>((s + kSide * kSide / 2) / (kSide * kSide));
            }
        }
    }
}

}  // namespace hewer::raster
