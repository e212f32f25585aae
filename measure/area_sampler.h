// SPDX-License-Identifier: MIT
/// Points spread over a surface by area, triangle by triangle.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "hewer/types.h"
#include "measure/lattice.h"

namespace hewer::measuring {

/// A triangle of area A gets A times the density samples, rounded up or down at random with that
/// mean, at the places of a low-discrepancy sequence (R2: Roberts 2018) with a random start. So
/// every point of the surface is equally likely. Number and places follow from the triangle's
/// corners and the seed alone: neither its place in the file nor the number of threads, nor memory,
/// show in them. Triangles of no area get no samples.
class AreaSampler {
  public:
    /// None at all.
    AreaSampler() = default;
    /// About `n_samples` on a surface of `area` square steps, to within a few times their square
    /// root; none if the area is 0.
    AreaSampler(double area, std::uint64_t n_samples, std::uint64_t seed)
        : per_area2_(area > 0 ? 0.5 * static_cast<double>(n_samples) / area : 0),
          seed_(mix(seed + 0x9e3779b97f4a7c15ULL)) {}

    [[nodiscard]] std::uint64_t count(const LatticeTriangle& t) const { return count(t, hash(t)); }

    /// visit(position in steps) for each sample of `t`.
    template <typename Visit>
    void for_samples(const LatticeTriangle& t, const Visit& visit) const {
        const std::uint64_t random = hash(t);
        const std::uint64_t n = count(t, random);
        if (n == 0) return;
        const Vec3 a = to_double(t[0]);
        const Vec3 b = to_double(t[1]);
        const Vec3 c = to_double(t[2]);
        // Fractions of 2^64 wrap by themselves: 1 / g and 1 / g^2 with g^3 = g + 1.
        constexpr std::uint64_t kStepU = 0xc13fa9a902a6328fULL;
        constexpr std::uint64_t kStepV = 0x91e10da5c79e7b1dULL;
        std::uint64_t u64 = mix(random + 1);
        std::uint64_t v64 = mix(random + 2);
        for (std::uint64_t i = 0; i < n; ++i) {
            double u = to_unit(u64);
            double v = to_unit(v64);
            // Uniform over the parallelogram of two edges; its far half is folded back.
            if (u + v > 1) {
                u = 1 - u;
                v = 1 - v;
            }
            visit(Vec3{a[0] + u * (b[0] - a[0]) + v * (c[0] - a[0]),
                       a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1]),
                       a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])});
            u64 += kStepU;
            v64 += kStepV;
        }
    }

    /// Twice the area of `t` in square steps.
    static double area2(const LatticeTriangle& t) {
        const Vec3 n = double_area_normal(t);
        return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }

    /// More than any surface gets for `n_samples` asked for, but once in 10^9.
    static std::uint64_t most(std::uint64_t n_samples) {
        constexpr double kDeviations = 6;
        constexpr double kRounded = 64;
        return n_samples + static_cast<std::uint64_t>(
                               kDeviations * std::sqrt(static_cast<double>(n_samples)) + kRounded);
    }

  private:
    /// The finaliser of SplitMix64 (Steele, Lea & Flood 2014).
    static std::uint64_t mix(std::uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
        return x ^ (x >> 31);
    }
    static double to_unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

    [[nodiscard]] std::uint64_t hash(const LatticeTriangle& t) const {
        std::uint64_t h = seed_;
        for (const LatticePoint& p : t) {
            const auto x = static_cast<std::uint32_t>(p[0]);
            const auto y = static_cast<std::uint32_t>(p[1]);
            const auto z = static_cast<std::uint32_t>(p[2]);
            h = mix(h ^ (std::uint64_t{x} << 32 | y)) + z;
        }
        return mix(h);
    }
    [[nodiscard]] std::uint64_t count(const LatticeTriangle& t, std::uint64_t random) const {
        return static_cast<std::uint64_t>(area2(t) * per_area2_ + to_unit(random));
    }

    double per_area2_ = 0;  // samples for twice a square step
    std::uint64_t seed_ = 0;
};

}  // namespace hewer::measuring
