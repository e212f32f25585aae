// SPDX-License-Identifier: MIT
#include "streaming/scan_surface.h"

#include <algorithm>
#include <cmath>

#include "streaming/lattice_noise.h"

namespace hewer::streaming {

namespace {

// Lengths below are in radii of the unscaled body.
constexpr float kLargeFrequency = 1.15F;
constexpr float kRoughFrequency = 2.3F;
constexpr float kRoughAmplitude = 0.075F;
constexpr float kRidgeFrequency = 3.1F;
constexpr float kRidgeAmplitude = 0.048F;
// Not 2, so that the lattices of different octaves have no planes in common.
constexpr float kLacunarity = 1.93F;
constexpr float kRoughGain = 0.47F;
constexpr float kRidgeGain = 0.5F;
constexpr std::size_t kMostRidgeOctaves = 5;
// A wave needs this many samples to show as one.
constexpr float kSamplesPerWave = 3;

constexpr float kGrooveDepth = 0.045F;
constexpr float kGrooveHalfWidth = 0.038F;
constexpr float kBaseHeight = 0.76F;     // of the body's centre above its base
constexpr float kFacetDistance = 0.90F;  // of the broken facet from the centre

// Shares of the sampling distance. With these no triangle of the sphere turns over.
constexpr float kHeightNoise = 0.17F;  // triangular: standard deviation 0.41 of it
constexpr float kSideNoise = 0.10F;

constexpr float kTwoToMinus20 = 1.0F / 1048576;

/// 0 below `from`, 1 above `to`, smooth between.
inline float smooth_step(float from, float to, float x) {
    const float t = std::min(std::max((x - from) / (to - from), 0.0F), 1.0F);
    return t * t * (3 - 2 * t);
}

}  // namespace

/// What is known of a block of vertices on the way to their positions.
struct ScanSurface::Fields {
    Block<float> dx, dy, dz;    // unit direction
    Block<float> height_noise;  // -1 .. 1
    Block<float> large_a, large_b, large_c;
    Block<float> qx, qy, qz;  // where relief is looked up
    Block<float> rough, ridges, relief;
    Block<float> radius;
};

ScanSurface::ScanSurface(const BoxGrid& grid, std::uint64_t seed)
    : grid_(grid),
      seed_(mix_bits(seed + 0x632be59bd9b4e019ULL)),
      step_xy_(2.0 / static_cast<double>(grid.width())),
      step_z_(2.0 / static_cast<double>(grid.height())),
      spacing_(static_cast<float>(
          std::sqrt(4 * 3.141592653589793 / static_cast<double>(grid.n_vertices())))),
      large_{make_octave(kLargeFrequency, 1), make_octave(kLargeFrequency, 1),
             make_octave(kLargeFrequency, 1)},
      lobes_(make_octave(1.9F, 1)),
      pigment_{make_octave(2.6F, 1), make_octave(7.3F, 1)} {
    const float finest = 1 / (kSamplesPerWave * spacing_);
    float amplitude = kRoughAmplitude;
    float frequency = kRoughFrequency;
    while (frequency <= std::max(finest, kRoughFrequency)) {
        rough_.push_back(make_octave(frequency, amplitude));
        frequency *= kLacunarity;
        amplitude *= kRoughGain;
    }
    amplitude = kRidgeAmplitude;
    frequency = kRidgeFrequency;
    while (frequency <= std::max(finest, kRidgeFrequency) && ridges_.size() < kMostRidgeOctaves) {
        ridges_.push_back(make_octave(frequency, amplitude));
        frequency *= kLacunarity;
        amplitude *= kRidgeGain;
    }
}

ScanSurface::Octave ScanSurface::make_octave(float frequency, float amplitude) {
    const std::uint64_t h = mix_bits(seed_ + 0x9e3779b97f4a7c15ULL * ++n_octaves_made_);
    const auto fraction = [](std::uint64_t bits) {
        return static_cast<float>(bits & 0xfffff) * kTwoToMinus20;
    };
    return {frequency,
            amplitude,
            {fraction(h), fraction(h >> 20), fraction(h >> 40)},
            static_cast<std::uint32_t>(mix_bits(h))};
}

void ScanSurface::evaluate(std::span<const std::uint64_t> vertices, bool with_color,
                           Samples& out) const {
    Fields f;
    place(vertices, f);
    shape(f);
    bend(f, out);
    if (with_color) paint(f, out);
}

void ScanSurface::place(std::span<const std::uint64_t> vertices, Fields& f) const {
    for (std::size_t i = 0; i < kBlock; ++i) {
        // A short block is filled up with its last vertex: whole blocks vectorise.
        const std::uint64_t vertex = vertices[std::min(i, vertices.size() - 1)];
        const BoxGrid::Point p = grid_.point(vertex);
        f.dx[i] = spread(p.x, step_xy_);
        f.dy[i] = spread(p.y, step_xy_);
        f.dz[i] = spread(p.z, step_z_);
        const std::uint64_t h = mix_bits(seed_ ^ (vertex * 0x9e3779b97f4a7c15ULL));
        const auto field = [h](int shift) {  // 12 bits, -1 .. 1
            return static_cast<float>(static_cast<std::int32_t>((h >> shift) & 0xfff)) *
                       (2.0F / 4095) -
                   1;
        };
        f.height_noise[i] = 0.5F * (field(0) + field(12));
        // Held until the direction is made.
        f.qx[i] = field(24);
        f.qy[i] = field(36);
        f.qz[i] = field(48);
    }
    const float aside = kSideNoise * spacing_;
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float inverse =
            1 / std::sqrt(f.dx[i] * f.dx[i] + f.dy[i] * f.dy[i] + f.dz[i] * f.dz[i]);
        const float x = f.dx[i] * inverse + aside * f.qx[i];
        const float y = f.dy[i] * inverse + aside * f.qy[i];
        const float z = f.dz[i] * inverse + aside * f.qz[i];
        const float again = 1 / std::sqrt(x * x + y * y + z * z);
        f.dx[i] = x * again;
        f.dy[i] = y * again;
        f.dz[i] = z * again;
    }
}

void ScanSurface::add_octave(const Octave& octave, const Block<float>& x, const Block<float>& y,
                             const Block<float>& z, Block<float>& sum) {
    const Octave o = octave;
    for (std::size_t i = 0; i < kBlock; ++i) {
        sum[i] += o.amplitude * lattice_noise(x[i] * o.frequency + o.offset[0],
                                              y[i] * o.frequency + o.offset[1],
                                              z[i] * o.frequency + o.offset[2], o.seed);
    }
}

void ScanSurface::shape(Fields& f) const {
    f.large_a = {};
    f.large_b = {};
    f.large_c = {};
    f.rough = {};
    f.ridges = {};
    f.radius = {};
    add_octave(large_[0], f.dx, f.dy, f.dz, f.large_a);
    add_octave(large_[1], f.dx, f.dy, f.dz, f.large_b);
    add_octave(large_[2], f.dx, f.dy, f.dz, f.large_c);
    add_octave(lobes_, f.dx, f.dy, f.dz, f.radius);

    // Relief is looked up in a warped space, which makes it flow instead of lying in a lattice.
    for (std::size_t i = 0; i < kBlock; ++i) {
        f.qx[i] = f.dx[i] + 0.30F * f.large_a[i];
        f.qy[i] = f.dy[i] + 0.30F * f.large_b[i];
        f.qz[i] = 1.3F * f.dz[i] + 0.30F * f.large_c[i];
    }
    for (const Octave& o : rough_) add_octave(o, f.qx, f.qy, f.qz, f.rough);

    // Ridged sum after Musgrave (1994): each scale shows only where the coarser one is high.
    Block<float> weight;
    weight.fill(1);
    for (const Octave& o : ridges_) {
        Block<float> noise{};
        add_octave({o.frequency, 1, o.offset, o.seed}, f.qx, f.qy, f.qz, noise);
        for (std::size_t i = 0; i < kBlock; ++i) {
            const float edge = std::max(1 - 2.2F * std::abs(noise[i]), 0.0F);
            const float signal = edge * edge * weight[i];
            weight[i] = std::min(2 * signal, 1.0F);
            f.ridges[i] += o.amplitude * signal;
        }
    }

    const float noise_height = kHeightNoise * spacing_;
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float x = f.dx[i];
        const float y = f.dy[i];
        const float z = f.dz[i];
        const float worn = 0.05F + 0.95F * smooth_step(-0.18F, 0.22F, f.large_b[i]);
        const float ridged = smooth_step(0.02F, 0.35F, f.large_c[i]);
        f.relief[i] = worn * f.rough[i] + ridged * f.ridges[i];
        float r = 1 + 0.20F * f.large_a[i] + 0.10F * f.radius[i] + f.relief[i];

        const float across =
            std::abs(0.45F * x + 0.25F * y + 0.86F * z - 0.02F + 0.10F * f.large_c[i]);
        r -= kGrooveDepth * std::max(1 - across * (1 / kGrooveHalfWidth), 0.0F);

        // Planes cut the body: along a direction, their distance is h / cosine. Stone breaks rough,
        // but finer than it weathers.
        const float facet = std::max(0.55F * x - 0.60F * y + 0.58F * z, 0.05F);
        r = std::min(r, (kFacetDistance + 0.04F * f.rough[i]) / facet);
        r = std::min(r, kBaseHeight / std::max(-z, 0.05F));
        f.radius[i] = r * (1 + noise_height * f.height_noise[i]);
    }
}

void ScanSurface::bend(Fields& f, Samples& out) const {
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float z = f.dz[i] * f.radius[i];
        // A neck, and shoulders below it: each height has its own positive scale, so the map is
        // one-to-one; so are the shears.
        const float u = (z + 0.10F) * (1 / 0.30F);
        const float bell = 1 / ((1 + u * u) * (1 + u * u));
        const float low = smooth_step(0.05F, 0.70F, -z);
        const float wide = 0.62F * (1 - 0.30F * bell) * (1 + 0.30F * low);
        const float deep = 0.62F * (1 - 0.26F * bell) * (1 + 0.04F * low);
        out.x[i] = wide * f.dx[i] * f.radius[i] + 0.08F * z * z;
        out.y[i] = deep * f.dy[i] * f.radius[i] - 0.10F * z;
        out.z[i] = z;
    }
}

void ScanSurface::paint(const Fields& f, Samples& out) const {
    Block<float> broad{};
    Block<float> fine{};
    add_octave(pigment_[0], f.qx, f.qy, f.qz, broad);
    add_octave(pigment_[1], f.qx, f.qy, f.qz, fine);
    using Rgb = std::array<float, 3>;
    constexpr Rgb kPale{214, 196, 164};
    constexpr Rgb kWarm{176, 120, 84};
    constexpr Rgb kBlue{48, 84, 132};
    constexpr Rgb kGreen{62, 118, 74};
    constexpr Rgb kGold{226, 178, 64};
    for (std::size_t i = 0; i < kBlock; ++i) {
        const float blend = smooth_step(-0.4F, 0.4F, broad[i]);
        Rgb c{};
        for (std::size_t k = 0; k < 3; ++k) c[k] = kPale[k] + blend * (kWarm[k] - kPale[k]);
        // Painted cloth with a golden hem, and patches of green that follow the pattern: sharp
        // edges.
        const float hem = f.dz[i] + 0.12F * f.large_a[i] + 0.22F;
        if (hem < 0) c = kBlue;
        if (hem < 0 && std::abs(fine[i]) < 0.06F) c = kGold;
        if (hem >= 0 && hem < 0.05F) c = kGold;
        if (hem > 0.1F && broad[i] > 0.33F) c = kGreen;
        // Dust in the hollows, worn light on the heights.
        const float light =
            0.95F + 2.0F * std::min(std::max(f.relief[i], -0.15F), 0.10F) + 0.10F * fine[i];
        for (std::size_t k = 0; k < 3; ++k) {
            out.color[i][k] =
                static_cast<std::uint8_t>(std::min(std::max(c[k] * light, 0.0F), 255.0F));
        }
    }
}

}  // namespace hewer::streaming
