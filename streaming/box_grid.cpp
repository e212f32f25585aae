// SPDX-License-Identifier: MIT
#include "streaming/box_grid.h"

#include <cmath>
#include <string>

#include "hewer/error.h"
#include "ooc/units.h"

namespace hewer::streaming {

namespace {

BoxGrid::Point make_point(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
    return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
            static_cast<std::uint32_t>(z)};
}

std::uint64_t integer_root(std::uint64_t square) {
    auto root = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(square)));
    while (root * root > square) --root;
    while ((root + 1) * (root + 1) <= square) ++root;
    return root;
}

}  // namespace

BoxGrid BoxGrid::for_triangles(std::uint64_t n_triangles) {
    if (n_triangles < kLeastTriangles) {
        throw InvalidArgument("a closed surface needs at least " + std::to_string(kLeastTriangles) +
                              " triangles, " + std::to_string(n_triangles) + " were asked for");
    }
    // A closed surface of genus 0 has n_triangles / 2 + 2 vertices; tested first, so that the
    // products below stay small.
    if (n_triangles / 2 + 2 > kMostVertices) {
        throw InvalidArgument(ooc::format_count(n_triangles) +
                              " triangles need more vertices than 32-bit indices tell apart; the "
                              "most is " +
                              ooc::format_count(2 * kMostVertices - 4));
    }
    // 4 (width^2 + 2 width height) triangles, height >= width.
    const std::uint64_t width = integer_root(n_triangles / 12);
    return {width, (n_triangles / 4 - width * width) / (2 * width)};
}

BoxGrid::Point BoxGrid::on_ring(std::uint64_t step, std::uint64_t z) const {
    const std::uint64_t n = width_;
    if (step < n) return make_point(step, 0, z);
    if (step < 2 * n) return make_point(n, step - n, z);
    if (step < 3 * n) return make_point(3 * n - step, n, z);
    return make_point(0, (4 * n - step) % (4 * n), z);
}

BoxGrid::Point BoxGrid::point(std::uint64_t vertex) const {
    const std::uint64_t row = width_ + 1;
    const std::uint64_t rings = 4 * width_ * (height_ - 1);
    if (vertex < layer_vertices()) return make_point(vertex % row, vertex / row, 0);
    vertex -= layer_vertices();
    if (vertex < rings) return on_ring(vertex % (4 * width_), 1 + vertex / (4 * width_));
    vertex -= rings;
    return make_point(vertex % row, vertex / row, height_);
}

std::uint64_t BoxGrid::vertex(const Point& p) const {
    const std::uint64_t n = width_;
    const std::uint64_t in_layer = p.y * (n + 1) + p.x;
    if (p.z == 0) return in_layer;
    const std::uint64_t before = layer_vertices() + 4 * n * (p.z - 1);
    if (p.z == height_) return before + in_layer;
    if (p.y == 0) return before + p.x;
    if (p.x == n) return before + n + p.y;
    if (p.y == n) return before + 3 * n - p.x;
    return before + 4 * n - p.y;
}

BoxGrid::Quad BoxGrid::quad(std::uint64_t index) const {
    const std::uint64_t n = width_;
    const std::uint64_t sides = 4 * n * height_;
    if (index < n * n) {
        const Point a = make_point(index % n, index / n, 0);
        return {a, {a.x, a.y + 1, 0}, {a.x + 1, a.y + 1, 0}, {a.x + 1, a.y, 0}};
    }
    index -= n * n;
    if (index < sides) {
        const std::uint64_t step = index % (4 * n);
        const std::uint64_t z = index / (4 * n);
        const Point a = on_ring(step, z);
        const Point b = on_ring(step + 1 == 4 * n ? 0 : step + 1, z);
        return {a, b, {b.x, b.y, b.z + 1}, {a.x, a.y, a.z + 1}};
    }
    index -= sides;
    const Point a = make_point(index % n, index / n, height_);
    return {a, {a.x + 1, a.y, a.z}, {a.x + 1, a.y + 1, a.z}, {a.x, a.y + 1, a.z}};
}

std::size_t BoxGrid::quads_around(const Point& p, std::array<Quad, 4>& out) const {
    const std::array<std::uint32_t, 3> at{p.x, p.y, p.z};
    const auto n = static_cast<std::uint32_t>(width_);
    const std::array<std::uint32_t, 3> size{n, n, static_cast<std::uint32_t>(height_)};
    std::size_t count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (at[axis] != 0 && at[axis] != size[axis]) continue;  // not on these two faces of the box
        const std::size_t u = (axis + 1) % 3;
        const std::size_t v = (axis + 2) % 3;
        for (std::uint32_t du = 0; du < 2; ++du) {
            for (std::uint32_t dv = 0; dv < 2; ++dv) {
                if (at[u] + du < 1 || at[u] + du > size[u]) continue;
                if (at[v] + dv < 1 || at[v] + dv > size[v]) continue;
                for (std::uint32_t k = 0; k < 4; ++k) {
                    std::array<std::uint32_t, 3> q = at;
                    q[u] += du - (k & 1);  // at + du - 1 .. at + du
                    q[v] += dv - (k >> 1);
                    out[count][k] = {q[0], q[1], q[2]};
                }
                ++count;
            }
        }
    }
    return count;
}

}  // namespace hewer::streaming
