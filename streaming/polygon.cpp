// SPDX-License-Identifier: MIT
#include "streaming/polygon.h"

#include <algorithm>
#include <cmath>

#include "ooc/vec3.h"

namespace hewer::streaming {

namespace {

/// Whether the diagonal from `a` to `c` cuts the quad into two triangles that look the same way.
bool is_diagonal(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(cross(b - a, c - a), cross(c - a, d - a)) > 0;
}

}  // namespace

const PolygonTriangles& PolygonTriangulation::triangulate(std::span<const Vec3> corners) {
    if (corners.size() == 4) {
        const bool keeps_fan = is_diagonal(corners[0], corners[1], corners[2], corners[3]) ||
                               !is_diagonal(corners[1], corners[2], corners[3], corners[0]);
        if (keeps_fan) {
            triangles_.assign({{0, 1, 2}, {0, 2, 3}});
        } else {
            triangles_.assign({{1, 2, 3}, {1, 3, 0}});
        }
        return triangles_;
    }
    if (!project(corners) || is_convex()) {
        fan(corners.size());
    } else {
        clip_ears();
    }
    return triangles_;
}

void PolygonTriangulation::fan(std::size_t n) {
    triangles_.clear();
    for (std::uint32_t i = 2; i < n; ++i) triangles_.push_back({0, i - 1, i});
}

/// Onto the axis plane that it is largest in. False if it has no area.
bool PolygonTriangulation::project(std::span<const Vec3> corners) {
    Vec3 normal{0, 0, 0};
    Vec3 previous = corners.back() - corners[0];
    for (const Vec3& corner : corners) {
        const Vec3 p = corner - corners[0];
        normal = normal + cross(previous, p);
        previous = p;
    }
    const Vec3 size{std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])};
    const std::size_t axis =
        static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
    if (!(size[axis] > 0) || !std::isfinite(size[0] + size[1] + size[2])) return false;
    // Turning left seen from where the normal points to.
    std::size_t x = (axis + 1) % 3;
    std::size_t y = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(x, y);
    points_.clear();
    for (const Vec3& corner : corners) {
        points_.push_back({corner[x] - corners[0][x], corner[y] - corners[0][y]});
    }
    return true;
}

/// Positive if a - b - c turns left.
double PolygonTriangulation::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Point& p = points_[a];
    const Point& q = points_[b];
    const Point& r = points_[c];
    return (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
}

bool PolygonTriangulation::is_convex() const {
    const std::uint32_t n = static_cast<std::uint32_t>(points_.size());
    for (std::uint32_t i = 0; i < n; ++i) {
        if (turn(i, (i + 1) % n, (i + 2) % n) < 0) return false;
    }
    return true;
}

/// Only a reflex corner can be the first to lie in the triangle that is cut off.
bool PolygonTriangulation::is_ear(std::uint32_t corner) const {
    const std::uint32_t a = previous_[corner];
    const std::uint32_t c = next_[corner];
    if (!(turn(a, corner, c) > 0)) return false;
    return std::none_of(reflex_.begin(), reflex_.end(), [&](std::uint32_t r) {
        // Holes are joined to their polygon by an edge that is passed twice, so that corners share
        // their place.
        const Point& p = points_[r];
        if (p == points_[a] || p == points_[corner] || p == points_[c]) return false;
        return turn(a, corner, r) >= 0 && turn(corner, c, r) >= 0 && turn(c, a, r) >= 0;
    });
}

/// Whether a corner is an ear changes only when one of its neighbours is cut off (Eberly 2002).
void PolygonTriangulation::clip_ears() {
    const std::uint32_t n = static_cast<std::uint32_t>(points_.size());
    triangles_.clear();
    reflex_.clear();
    next_.resize(n);
    previous_.resize(n);
    is_ear_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        next_[i] = (i + 1) % n;
        previous_[i] = (i + n - 1) % n;
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        if (!(turn(previous_[i], i, next_[i]) > 0)) reflex_.push_back(i);
    }
    for (std::uint32_t i = 0; i < n; ++i) is_ear_[i] = is_ear(i);
    std::uint32_t corner = 0;
    for (std::uint32_t n_left = n; n_left > 3; --n_left) {
        // Without any ear, it intersects itself, or rounding says so: the corner at hand will do.
        for (std::uint32_t i = 0; i < n_left && !is_ear_[corner]; ++i) corner = next_[corner];
        const std::uint32_t a = previous_[corner];
        const std::uint32_t c = next_[corner];
        triangles_.push_back({a, corner, c});
        next_[a] = c;
        previous_[c] = a;
        std::erase_if(reflex_, [&](std::uint32_t r) {
            return r == corner || ((r == a || r == c) && turn(previous_[r], r, next_[r]) > 0);
        });
        is_ear_[a] = is_ear(a);
        is_ear_[c] = is_ear(c);
        // Two steps on, so that not all triangles meet in one corner.
        corner = next_[c];
    }
    triangles_.push_back({previous_[corner], corner, next_[corner]});
}

}  // namespace hewer::streaming
