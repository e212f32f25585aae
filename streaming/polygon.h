// SPDX-License-Identifier: MIT
/// Polygons to triangles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hewer/types.h"

namespace hewer::streaming {

/// Triangles of a polygon, as corner numbers.
using PolygonTriangles = std::vector<std::array<std::uint32_t, 3>>;

/// Cuts a polygon into as many triangles as its fan has: the fan of its first corner if it is
/// convex, else ears, one after the other, as they are in the plane of its Newell normal. What has
/// no plane (no area, not finite) stays a fan; what intersects itself is cut somehow. O(n r + n^2)
/// of simple steps for n corners, r of them reflex. Keeps its storage.
class PolygonTriangulation {
  public:
    /// At least four corners. The result is valid until the next call.
    const PolygonTriangles& triangulate(std::span<const Vec3> corners);

  private:
    using Point = std::array<double, 2>;
    bool project(std::span<const Vec3> corners);
    [[nodiscard]] double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    [[nodiscard]] bool is_convex() const;
    [[nodiscard]] bool is_ear(std::uint32_t corner) const;
    void clip_ears();
    void fan(std::size_t n);

    std::vector<Point> points_;  // relative to the first corner, turning left on the whole
    std::vector<std::uint32_t> next_;
    std::vector<std::uint32_t> previous_;
    std::vector<std::uint32_t> reflex_;
    std::vector<bool> is_ear_;
    PolygonTriangles triangles_;
};

}  // namespace hewer::streaming
