// SPDX-License-Identifier: MIT
/// The shape of a generated scan: where each vertex of the grid lies and how it is painted, as a
/// pure function of its id and the seed.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "streaming/box_grid.h"

namespace hewer::streaming {

/// A stone bust of about 1.35 x 1.25 x 1.8 units, as a structured-light scanner sees it: a rounded
/// body with lobes and a neck, weathered relief on all scales that the sampling resolves (each
/// about half as wide and half as high as the one before), ridges in one region, worn smooth parts,
/// a V-shaped groove around it, a sawn flat base and a broken-off facet (all with sharp edges), and
/// the noise of the scanner. The large shapes depend on the seed alone; more triangles add finer
/// relief.
///
/// How: the box is projected to the unit sphere, the sphere is moved along its radii (so that the
/// surface cannot meet itself, whatever the relief), and space is then bent by maps that are
/// one-to-one. Scanner noise is white: in height, triangular with a standard deviation of 7 % of
/// the sampling distance; sideways, uniform within +-10 %.
///
/// Float arithmetic with + - * / sqrt only: the same bits for any order, batch and thread. Of order
/// 100 ns a vertex. Thread-safe.
class ScanSurface {
  public:
    /// Vertices are computed in blocks of this many, side by side in vector registers.
    static constexpr std::size_t kBlock = 256;
    template <typename T>
    using Block = std::array<T, kBlock>;

    struct Samples {
        Block<float> x;
        Block<float> y;
        Block<float> z;
        Block<std::array<std::uint8_t, 3>> color;  ///< untouched unless asked for
    };

    ScanSurface(const BoxGrid& grid, std::uint64_t seed);

    /// At most kBlock vertices, any ids. Entries of `out` behind them are undefined.
    void evaluate(std::span<const std::uint64_t> vertices, bool with_color, Samples& out) const;

    /// The grid point's place on the unit sphere, before noise.
    [[nodiscard]] std::array<float, 3> direction(const BoxGrid::Point& p) const {
        const float x = spread(p.x, step_xy_);
        const float y = spread(p.y, step_xy_);
        const float z = spread(p.z, step_z_);
        const float inverse = 1 / std::sqrt(x * x + y * y + z * z);
        return {x * inverse, y * inverse, z * inverse};
    }
    /// Mean distance of neighbours on the unit sphere.
    [[nodiscard]] float spacing() const { return spacing_; }

  private:
    /// One scale of relief: noise(frequency * p + offset).
    struct Octave {
        float frequency;
        float amplitude;
        std::array<float, 3> offset;
        std::uint32_t seed;
    };
    struct Fields;

    /// About tan(pi/4 t), which spreads the grid of a cube's face evenly over the sphere, for
    /// t = step * i - 1 in -1 .. 1.
    static float spread(std::uint32_t i, double step) {
        const double t = step * static_cast<double>(i) - 1.0;
        const double t2 = t * t;
        return static_cast<float>(t * (0.7854 + t2 * (0.1615 + t2 * 0.0531)));
    }
    Octave make_octave(float frequency, float amplitude);
    static void add_octave(const Octave& octave, const Block<float>& x, const Block<float>& y,
                           const Block<float>& z, Block<float>& sum);
    void place(std::span<const std::uint64_t> vertices, Fields& f) const;
    void shape(Fields& f) const;
    void bend(Fields& f, Samples& out) const;
    void paint(const Fields& f, Samples& out) const;

    BoxGrid grid_;
    std::uint64_t seed_;
    std::uint64_t n_octaves_made_ = 0;
    double step_xy_;  // between grid points of a cube from -1 to 1
    double step_z_;
    float spacing_;
    std::array<Octave, 3> large_;  // three independent fields of the lowest frequency
    Octave lobes_;
    std::vector<Octave> rough_;  // weathered stone
    std::vector<Octave> ridges_;
    std::array<Octave, 2> pigment_;
};

}  // namespace hewer::streaming
