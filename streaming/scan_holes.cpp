// SPDX-License-Identifier: MIT
#include "streaming/scan_holes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ooc/parallel.h"
#include "streaming/lattice_noise.h"

namespace hewer::streaming {

namespace {

// Chords of the unit sphere, large to small: about 3 % of the surface in all.
constexpr std::array kRadii{0.21F,  0.15F,  0.11F, 0.085F, 0.06F, 0.06F, 0.045F,
                            0.032F, 0.025F, 0.02F, 0.015F, 0.01F, 0.01F};
// The rim lies between these shares of the radius, but for one sampling distance.
constexpr float kRimNoise = 0.35F;
// Sampling distances by which a neighbour can be nearer, and the white noise on the rim.
constexpr float kNeighbour = 3;
constexpr float kRimJitter = 1.2F;

float squared(float x) {
    return x * x;
}

}  // namespace

ScanHoles::ScanHoles(const ScanSurface& surface, std::uint64_t seed)
    : surface_(surface), seed_(static_cast<std::uint32_t>(mix_bits(seed ^ 0x686f6c6573ULL))) {
    std::uint64_t h = seed_;
    const float margin = (kNeighbour + kRimJitter) * surface.spacing();
    static_assert(kRadii.size() <= kMostDiscs);
    clear2_.fill(-1);
    gone2_.fill(-1);
    for (std::size_t disc = 0; disc < kRadii.size(); ++disc) {
        std::array<float, 3> c{};
        float length2 = 0;
        do {  // a point of the ball, evenly distributed, brought out to the sphere
            h = mix_bits(h + 0x9e3779b97f4a7c15ULL);
            for (std::size_t k = 0; k < 3; ++k) {
                c[k] = static_cast<float>((h >> (20 * k)) & 0xfffff) * (2.0F / 1048575) - 1;
            }
            length2 = squared(c[0]) + squared(c[1]) + squared(c[2]);
        } while (length2 > 1 || length2 < 0.01F);
        const float length = std::sqrt(length2);
        x_[disc] = c[0] / length;
        y_[disc] = c[1] / length;
        z_[disc] = c[2] / length;
        const float radius = kRadii[disc];
        radius_[disc] = radius;
        clear2_[disc] = squared(radius * (1 + kRimNoise) + margin);
        gone2_[disc] = squared(std::max(radius * (1 - kRimNoise) - margin, 0.0F));
    }
}

ScanHoles::Place ScanHoles::locate(const std::array<float, 3>& direction) const {
    int is_near = 0;
    int is_gone = 0;
    for (std::size_t disc = 0; disc < kMostDiscs; ++disc) {
        const float d2 = squared(direction[0] - x_[disc]) + squared(direction[1] - y_[disc]) +
                         squared(direction[2] - z_[disc]);
        is_near |= static_cast<int>(d2 <= clear2_[disc]);
        is_gone |= static_cast<int>(d2 < gone2_[disc]);
    }
    if (is_gone != 0) return Place::Gone;
    return is_near != 0 ? Place::Rim : Place::Clear;
}

bool ScanHoles::is_seen_on_rim(const std::array<float, 3>& direction,
                               const BoxGrid::Point& p) const {
    const std::uint64_t h =
        mix_bits((std::uint64_t{seed_} << 32) + p.x + mix_bits((std::uint64_t{p.y} << 32) + p.z));
    const float jitter =
        kRimJitter * surface_.spacing() * (static_cast<float>(h & 0xffff) * (1.0F / 65535) - 0.5F);
    for (std::size_t disc = 0; disc < kMostDiscs; ++disc) {
        const float d2 = squared(direction[0] - x_[disc]) + squared(direction[1] - y_[disc]) +
                         squared(direction[2] - z_[disc]);
        if (d2 > clear2_[disc]) continue;
        // Lobes as large as the disc, and tatters.
        float noise = 0;
        float weight = 0.8F;
        for (const float frequency : {1.5F, 5.0F, 16.0F}) {
            const float f = frequency / radius_[disc];
            noise +=
                weight * lattice_noise(direction[0] * f, direction[1] * f, direction[2] * f, seed_);
            weight *= 0.5F;
        }
        noise = std::clamp(noise, -kRimNoise, kRimNoise);
        const float radius = std::max(radius_[disc] * (1 + noise) + jitter, 0.0F);
        if (d2 < radius * radius) return false;
    }
    return true;
}

bool ScanHoles::is_seen(const BoxGrid::Point& p) const {
    const std::array<float, 3> direction = surface_.direction(p);
    switch (locate(direction)) {
        case Place::Clear:
            return true;
        case Place::Gone:
            return false;
        case Place::Rim:
            break;
    }
    return is_seen_on_rim(direction, p);
}

std::array<bool, 4> ScanHoles::are_seen(const BoxGrid::Quad& quad) const {
    // What is clear or gone is so with its neighbours.
    const Place place = locate(surface_.direction(quad[0]));
    if (place == Place::Clear) return {true, true, true, true};
    if (place == Place::Gone) return {};
    return {is_seen(quad[0]), is_seen(quad[1]), is_seen(quad[2]), is_seen(quad[3])};
}

bool ScanHoles::is_used(const BoxGrid& grid, const BoxGrid::Point& p) const {
    const std::array<float, 3> direction = surface_.direction(p);
    const Place place = locate(direction);
    if (place != Place::Rim) return place == Place::Clear;
    if (!is_seen_on_rim(direction, p)) return false;
    // Three seen corners make a triangle, and any three of a quad's corners that include p do.
    std::array<BoxGrid::Quad, 4> quads{};
    const std::size_t n = grid.quads_around(p, quads);
    return std::any_of(quads.begin(), quads.begin() + static_cast<std::ptrdiff_t>(n),
                       [&](const BoxGrid::Quad& quad) {
                           return std::count_if(quad.begin(), quad.end(), [&](const auto& corner) {
                                      return is_seen(corner);
                                  }) >= 3;
                       });
}

QuadTriangles cut_quad(const std::array<bool, 4>& seen, bool diagonal_02) {
    const int n_seen = int{seen[0]} + int{seen[1]} + int{seen[2]} + int{seen[3]};
    if (n_seen == 4) {
        if (diagonal_02) return {2, {{{0, 1, 2}, {0, 2, 3}}}};
        return {2, {{{0, 1, 3}, {1, 2, 3}}}};
    }
    if (n_seen < 3) return {};
    if (!seen[0]) return {1, {{{1, 2, 3}}}};
    if (!seen[1]) return {1, {{{0, 2, 3}}}};
    if (!seen[2]) return {1, {{{0, 1, 3}}}};
    return {1, {{{0, 1, 2}}}};
}

UsedVertices::UsedVertices(const BoxGrid& grid, const ScanHoles& holes, ooc::Context& context)
    : grid_(grid),
      holes_(holes),
      first_(context.budget(), "vertex counts of the scan",
             (grid.n_vertices() + kRun - 1) / kRun + 1) {
    context.workers().for_ranges(first_.size() - 1, 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t run = begin; run < end; ++run) {
            context.check_stop();
            const std::uint64_t last = std::min((run + 1) * kRun, grid_.n_vertices());
            std::uint64_t n = 0;
            for (std::uint64_t v = run * kRun; v < last; ++v) {
                n += static_cast<std::uint64_t>(holes_.is_used(grid_, grid_.point(v)));
            }
            first_[run + 1] = n;
        }
    });
    for (std::uint64_t run = 1; run < first_.size(); ++run) first_[run] += first_[run - 1];
}

const UsedVertices::Lookup::Page& UsedVertices::Lookup::page(std::uint64_t run) {
    if (pages_[last_].run == run) return pages_[last_];
    for (std::size_t i = 0; i < kPages; ++i) {
        if (pages_[i].run == run) {
            last_ = i;
            return pages_[i];
        }
    }
    last_ = next_;
    next_ = (next_ + 1) % kPages;
    Page& page = pages_[last_];
    page.run = run;
    const std::uint64_t first = run * kRun;
    const std::uint64_t last = std::min(first + kRun, used_.grid_.n_vertices());
    page.bits.fill(0);
    for (std::uint64_t v = first; v < last; ++v) {
        const bool used = used_.holes_.is_used(used_.grid_, used_.grid_.point(v));
        page.bits[(v - first) / 64] |= std::uint64_t{used} << (v % 64);
    }
    std::uint16_t before = 0;
    for (std::size_t w = 0; w < kWords; ++w) {
        page.before[w] = before;
        before = static_cast<std::uint16_t>(before + std::popcount(page.bits[w]));
    }
    return page;
}

std::uint64_t UsedVertices::Lookup::operator()(std::uint64_t vertex) {
    const std::uint64_t run = vertex / kRun;
    const Page& p = page(run);
    const std::uint64_t word = vertex % kRun / 64;
    const std::uint64_t below = p.bits[word] & ((std::uint64_t{1} << (vertex % 64)) - 1);
    return used_.first_[run] + p.before[word] + static_cast<std::uint64_t>(std::popcount(below));
}

}  // namespace hewer::streaming
