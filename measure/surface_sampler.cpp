// SPDX-License-Identifier: MIT
#include "measure/surface_sampler.h"

#include <algorithm>

#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kBlocksPerTask = 64;

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014).
std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

}  // namespace

SurfaceSampler::SurfaceSampler(ooc::Context& context, std::span<const LatticeTriangle> triangles,
                               std::uint64_t n_samples, std::uint64_t seed)
    : triangles_(triangles),
      n_samples_(n_samples),
      seed_(mix(seed + 0x9e3779b97f4a7c15ULL)),
      n_blocks_((triangles.size() + kBlock - 1) / kBlock),
      area2_before_(context.budget(), "areas for sampling", n_blocks_ + 1) {
    context.workers().for_ranges(
        n_blocks_, kBlocksPerTask, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t b = begin; b < end; ++b) {
                double sum = 0;
                const std::uint64_t last =
                    std::min<std::uint64_t>((b + 1) * kBlock, triangles.size());
                for (std::uint64_t t = b * kBlock; t < last; ++t) sum += area2(triangles[t]);
                area2_before_[b + 1] = sum;
            }
        });
    for (std::uint64_t b = 0; b < n_blocks_; ++b) area2_before_[b + 1] += area2_before_[b];
    if (!(area2_before_[n_blocks_] > 0)) n_samples_ = 0;
}

double SurfaceSampler::random(std::uint64_t k, std::uint64_t use) const {
    const std::uint64_t bits = mix(seed_ ^ mix(4 * k + use + 1));
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

std::uint64_t SurfaceSampler::block_at(double at) const {
    const auto* const begin = area2_before_.begin();
    const auto* const it = std::upper_bound(begin + 1, begin + n_blocks_, at);
    return static_cast<std::uint64_t>(it - begin) - 1;
}

Vec3 SurfaceSampler::point_in(const LatticeTriangle& t, std::uint64_t k) const {
    // Uniform over the parallelogram of two edges; its far half is folded back.
    double u = random(k, 1);
    double v = random(k, 2);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const Vec3 a = to_double(t[0]);
    const Vec3 b = to_double(t[1]);
    const Vec3 c = to_double(t[2]);
    return {a[0] + u * (b[0] - a[0]) + v * (c[0] - a[0]),
            a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1]),
            a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])};
}

}  // namespace hewer::measuring
