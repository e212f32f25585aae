// SPDX-License-Identifier: MIT
/// What a proof is after, and how much it may cost.
#pragma once

#include <atomic>
#include <cstdint>

namespace hewer::measuring {

/// What is looked at for this many triangles of both surfaces: 32 for each, and some for small
/// ones.
constexpr std::uint64_t most_pieces(std::uint64_t n_triangles) {
    constexpr std::uint64_t kPerTriangle = 32;
    constexpr std::uint64_t kBesides = 1 << 20;
    return kPerTriangle * n_triangles + kBesides;
}

/// Shared by all workers of a proof.
class PieceLimits {
  public:
    /// `distance` in steps, above 0; at most `most` pieces are looked at.
    PieceLimits(double distance, std::uint64_t most)
        : near_(distance * distance), hair_(kHair * distance * (kHair * distance)), most_(most) {}

    /// Pieces within this are near enough; square steps.
    [[nodiscard]] double near() const { return near_; }
    /// Whether a piece of this squared radius is too small to halve: what is beyond near() lies
    /// there within a hundredth of it, or farther.
    [[nodiscard]] bool is_hair(double squared_radius) const { return squared_radius <= hair_; }

    /// Thread-safe.
    void count(std::uint64_t n) { n_.fetch_add(n, std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t n() const { return n_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool is_spent() const { return n() > most_; }

  private:
    static constexpr double kHair = 0.01;

    double near_;
    double hair_;
    std::uint64_t most_;
    std::atomic<std::uint64_t> n_{0};
};

}  // namespace hewer::measuring
