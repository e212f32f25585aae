// SPDX-License-Identifier: MIT
/// Triangles to pixels: an orthographic z-buffer that any number of threads draw into.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hewer/types.h"
#include "ooc/array.h"
#include "ooc/memory_budget.h"

namespace hewer::raster {

/// Red, green, blue, 0..1, as the screen shows them.
using Color = std::array<float, 3>;

/// Where the viewer stands: an orthonormal frame and the size of a model unit on the picture.
struct Camera {
    Vec3 right{};
    Vec3 up{};
    Vec3 toward{};               ///< from the model to the viewer
    double pixels_per_unit = 1;  ///< the model's origin is in the middle of the picture
    double depth_range = 1;      ///< |depth| of all points along `toward`, model units
};

struct Style {
    Color front{0.84F, 0.82F, 0.78F};
    Color back{0.83F, 0.22F, 0.18F};  ///< a warning: seen from inside
    Color background_top{0.97F, 0.975F, 0.98F};
    Color background_bottom{0.86F, 0.87F, 0.885F};
    bool edges = false;
};

/// Each pixel has 2 x 2 samples; a sample keeps depth and colour of the nearest triangle in one
/// 64-bit word, depth above colour, updated by an atomic minimum. So the picture does not depend on
/// the order of the triangles or on the threads that draw them, equal depths included.
///
/// Samples are tested against inclusive edges, so that no crack shows between neighbours. Light is
/// flat, one for a triangle: a key light beside the viewer, the sky, and a little light from
/// everywhere; the colours of corners are blended across it. Front faces are those that appear
/// counter-clockwise.
/// Memory: 32 bytes a pixel, reserved.
class Rasteriser {
  public:
    Rasteriser(ooc::MemoryBudget& budget, unsigned width, unsigned height, const Camera& camera,
               const Style& style);

    /// Of the corners of a triangle.
    using Paint = std::array<Color, 3>;

    /// Draws a triangle given by its corners relative to the camera's origin. `paint`, if not null,
    /// replaces the front colour. Triangles with non-finite corners are left out. Thread-safe.
    void draw(const std::array<Vec3, 3>& corners, const Paint* paint);

    /// Averages the samples, background where there is none: 3 bytes a pixel, top row first.
    void resolve(std::span<std::uint8_t> pixels) const;

  private:
    struct Screen {  // in samples, origin top left; depth 0 (near) .. 1 (far)
        double x, y, depth;
    };
    [[nodiscard]] Screen project(const Vec3& p) const;
    void fill(const std::array<Screen, 3>& p, double area, const Paint& colors);
    void keep_nearest(std::uint64_t index, std::uint64_t word);

    unsigned width_;
    unsigned height_;
    Camera camera_;
    Style style_;
    Vec3 key_light_{};
    Vec3 sky_{};
    double scale_;                       // samples per unit
    ooc::Array<std::uint64_t> samples_;  // inverted, so that zeroed pages mean "nothing yet"
};

}  // namespace hewer::raster
