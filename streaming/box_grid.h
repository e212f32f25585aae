// SPDX-License-Identifier: MIT
/// The connectivity of a generated surface: a closed grid of quads on the skin of a box, every id a
/// formula.
#pragma once

#include <array>
#include <cstdint>

namespace hewer::streaming {

/// The skin of a box of width x width x height unit cubes: closed, manifold, genus 0. Nothing is
/// stored: ids and grid points follow from each other in constant time.
///
/// Order of vertices: the layer z = 0 row by row, the rings z = 1 .. height-1 counter-clockwise
/// seen from above, the layer z = height row by row. Quads likewise, so that neighbours in the file
/// use nearby vertices: ids that one quad uses differ by little more than a ring (4 * width), as in
/// the grids that range scanners deliver, but for the one row of quads at each of the two seams.
class BoxGrid {
  public:
    struct Point {
        std::uint32_t x = 0;  ///< 0 .. width
        std::uint32_t y = 0;  ///< 0 .. width
        std::uint32_t z = 0;  ///< 0 .. height
    };
    /// Corners counter-clockwise seen from outside.
    using Quad = std::array<Point, 4>;

    /// The box with the most triangles (two a quad) not above `n_triangles`; fewer than that by
    /// less than one ring of quads, 8 * width triangles. Throws InvalidArgument below
    /// kLeastTriangles, and if the box would have more than 2^32 vertices, which a PLY's indices
    /// cannot tell apart.
    static BoxGrid for_triangles(std::uint64_t n_triangles);

    static constexpr std::uint64_t kLeastTriangles = 12;
    static constexpr std::uint64_t kMostVertices = std::uint64_t{1} << 32;

    [[nodiscard]] std::uint64_t width() const { return width_; }
    [[nodiscard]] std::uint64_t height() const { return height_; }
    [[nodiscard]] std::uint64_t n_vertices() const {
        return 2 * layer_vertices() + 4 * width_ * (height_ - 1);
    }
    [[nodiscard]] std::uint64_t n_quads() const {
        return 2 * width_ * width_ + 4 * width_ * height_;
    }

    [[nodiscard]] Point point(std::uint64_t vertex) const;
    /// `p` must lie on the skin.
    [[nodiscard]] std::uint64_t vertex(const Point& p) const;
    [[nodiscard]] Quad quad(std::uint64_t index) const;
    /// The quads that meet in `p`: three at the eight corners of the box, four elsewhere.
    /// Their corners are in no particular order. Returns how many there are.
    std::size_t quads_around(const Point& p, std::array<Quad, 4>& out) const;

  private:
    BoxGrid(std::uint64_t width, std::uint64_t height) : width_(width), height_(height) {}
    [[nodiscard]] std::uint64_t layer_vertices() const { return (width_ + 1) * (width_ + 1); }
    [[nodiscard]] Point on_ring(std::uint64_t step, std::uint64_t z) const;

    std::uint64_t width_;
    std::uint64_t height_;
};

}  // namespace hewer::streaming
