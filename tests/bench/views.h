// SPDX-License-Identifier: MIT
/// The twenty views of Lindstrom & Turk 2000 ("Image-driven simplification"): pictures of 256 x 256
/// pixels from the vertices of a dodecahedron around a model's box, by the rasteriser of `hewer
/// render`.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hewer/types.h"
#include "render/rasteriser.h"

namespace bench {

struct Sphere {
    hewer::Vec3 center{};
    double radius = 0;
};

/// Around the box of the points, of which there must be one.
Sphere bounding_sphere(std::span<const hewer::Vec3> points);

/// Unit directions to the twenty vertices: those of a cube, and of three golden rectangles.
std::vector<hewer::Vec3> dodecahedron();

/// Looks at the middle of a sphere from `toward`, a unit direction; it nearly fills a picture of
/// `side` pixels squared.
hewer::raster::Camera camera_at(const hewer::Vec3& toward, double radius, unsigned side);

/// Draws a model whose origin is the sphere's centre; `pixel` is the length of one.
using DrawModel = std::function<void(hewer::raster::Rasteriser& rasteriser, double pixel)>;

/// Red, green and blue of all pixels of all views, one view after the other.
std::vector<std::uint8_t> render_views(const Sphere& sphere, const DrawModel& draw);

}  // namespace bench
