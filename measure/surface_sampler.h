// SPDX-License-Identifier: MIT
/// Points spread over a surface by area.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "hewer/types.h"
#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Stratified sampling: the triangles are laid end to end by area, in the order given, the whole is
/// cut into n equal stretches, and one point is taken at random from each. So every point of the
/// surface is equally likely, neighbours in an order that is coherent in space share the samples of
/// their common area evenly (less variance than independent samples), and exactly n samples come
/// out. Sample k is a function of triangles, n, seed and k alone.
///
/// Two uses: here, and to know the area. Triangles of no area get no samples; a surface of no area
/// gets none at all.
/// Memory: 8 bytes for each kBlock triangles. Triangles must outlive the sampler.
class SurfaceSampler {
  public:
    SurfaceSampler(ooc::Context& context, std::span<const LatticeTriangle> triangles,
                   std::uint64_t n_samples, std::uint64_t seed);

    [[nodiscard]] std::uint64_t n_samples() const { return n_samples_; }
    /// In square steps.
    [[nodiscard]] double area() const { return 0.5 * area2_before_[n_blocks_]; }

    /// visit(position in steps, number of its triangle) for samples first .. last-1, in order.
    /// Thread-safe.
    template <typename Visit>
    void for_samples(std::uint64_t first, std::uint64_t last, const Visit& visit) const;

    static std::uint64_t bytes(std::uint64_t n_triangles) {
        return (n_triangles / kBlock + 2) * sizeof(double);
    }

  private:
    static constexpr std::uint64_t kBlock = 256;  // triangles walked over to find a first sample

    static double area2(const LatticeTriangle& t) {
        const Vec3 n = double_area_normal(t);
        return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    /// In [0, 1), for each of a few `use`s of sample k.
    [[nodiscard]] double random(std::uint64_t k, std::uint64_t use) const;
    [[nodiscard]] std::uint64_t block_at(double at) const;
    [[nodiscard]] Vec3 point_in(const LatticeTriangle& t, std::uint64_t k) const;

    std::span<const LatticeTriangle> triangles_;
    std::uint64_t n_samples_;
    std::uint64_t seed_;
    std::uint64_t n_blocks_;
    ooc::Array<double> area2_before_;  // twice the area of all blocks before; the sum at the end
};

template <typename Visit>
void SurfaceSampler::for_samples(std::uint64_t first, std::uint64_t last,
                                 const Visit& visit) const {
    const double stretch = area2_before_[n_blocks_] / static_cast<double>(n_samples_);
    const auto place = [&](std::uint64_t k) {
        return (static_cast<double>(k) + random(k, 0)) * stretch;
    };
    if (first >= last) return;
    std::uint64_t block = block_at(place(first));
    std::uint64_t triangle = block * kBlock;
    // The triangle's end is at area2_before_[block] + within, summed exactly as the constructor
    // did: the same bits whichever sample the walk began with.
    double within = area2(triangles_[triangle]);
    for (std::uint64_t k = first; k < last; ++k) {
        const double at = place(k);
        if (area2_before_[block + 1] <= at && block + 1 < n_blocks_) {
            block = block_at(at);
            triangle = block * kBlock;
            within = area2(triangles_[triangle]);
        }
        while (area2_before_[block] + within <= at && triangle + 1 < triangles_.size()) {
            ++triangle;
            within += area2(triangles_[triangle]);
        }
        visit(point_in(triangles_[triangle], k), triangle);
    }
}

}  // namespace hewer::measuring
