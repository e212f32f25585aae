// SPDX-License-Identifier: MIT
/// Gradient noise on the integer lattice, without tables, in a form that compilers vectorise.
#pragma once

#include <cstdint>

namespace hewer::streaming {

/// A bijection of 64 bits whose every output bit depends on every input bit (the finaliser of
/// splitmix64, Steele et al. 2014).
inline std::uint64_t mix_bits(std::uint64_t h) {
    h ^= h >> 30;
    h *= 0xbf58476d1ce4e5b9ULL;
    h ^= h >> 27;
    h *= 0x94d049bb133111ebULL;
    return h ^ (h >> 31);
}

/// Smooth noise of unit wavelength (Perlin 2002: quintic fade, one gradient a lattice point); here
/// the gradient comes from an integer hash of the point and is not of unit length. Mean 0, standard
/// deviation about 0.3, seldom beyond +-1. Twice differentiable.
///
/// Only + - * and conversions, no libm and no branches: the same bits on every machine that rounds
/// as IEEE 754 says, scalar or vectorised. |x|, |y|, |z| < 2^31; good down to a resolution of 2^-24
/// of the coordinates. Always inlined: a loop around it is vectorised only then.
[[gnu::always_inline]] inline float lattice_noise(float x, float y, float z, std::uint32_t seed) {
    // Floor: truncation, less one where that went up.
    auto ix = static_cast<std::int32_t>(x);
    auto iy = static_cast<std::int32_t>(y);
    auto iz = static_cast<std::int32_t>(z);
    ix -= static_cast<std::int32_t>(x < static_cast<float>(ix));
    iy -= static_cast<std::int32_t>(y < static_cast<float>(iy));
    iz -= static_cast<std::int32_t>(z < static_cast<float>(iz));
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const float fz = z - static_cast<float>(iz);

    constexpr std::uint32_t kX = 0x9e3779b1U;
    constexpr std::uint32_t kY = 0x85ebca77U;
    constexpr std::uint32_t kZ = 0xc2b2ae3dU;
    const std::uint32_t hx = static_cast<std::uint32_t>(ix) * kX + seed;
    const std::uint32_t hy = static_cast<std::uint32_t>(iy) * kY;
    const std::uint32_t hz = static_cast<std::uint32_t>(iz) * kZ;

    // The gradient's coordinates are three signed fields of ten bits.
    const auto slope = [](std::uint32_t h, float dx, float dy, float dz) {
        h ^= h >> 15;
        h *= 0x2c1b3c6dU;
        h ^= h >> 13;
        const auto gx = static_cast<float>(static_cast<std::int32_t>(h) >> 22);
        const auto gy = static_cast<float>(static_cast<std::int32_t>(h << 10) >> 22);
        const auto gz = static_cast<float>(static_cast<std::int32_t>(h << 20) >> 22);
        return gx * dx + gy * dy + gz * dz;
    };
    const float n000 = slope(hx ^ hy ^ hz, fx, fy, fz);
    const float n100 = slope((hx + kX) ^ hy ^ hz, fx - 1, fy, fz);
    const float n010 = slope(hx ^ (hy + kY) ^ hz, fx, fy - 1, fz);
    const float n110 = slope((hx + kX) ^ (hy + kY) ^ hz, fx - 1, fy - 1, fz);
    const float n001 = slope(hx ^ hy ^ (hz + kZ), fx, fy, fz - 1);
    const float n101 = slope((hx + kX) ^ hy ^ (hz + kZ), fx - 1, fy, fz - 1);
    const float n011 = slope(hx ^ (hy + kY) ^ (hz + kZ), fx, fy - 1, fz - 1);
    const float n111 = slope((hx + kX) ^ (hy + kY) ^ (hz + kZ), fx - 1, fy - 1, fz - 1);

    const float u = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
    const float v = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
    const float w = fz * fz * fz * (fz * (fz * 6 - 15) + 10);
    const float a = n000 + u * (n100 - n000);
    const float b = n010 + u * (n110 - n010);
    const float c = n001 + u * (n101 - n001);
    const float d = n011 + u * (n111 - n011);
    const float near = a + v * (b - a);
    const float far = c + v * (d - c);
    return (near + w * (far - near)) * (1.25F / 512);
}

}  // namespace hewer::streaming
