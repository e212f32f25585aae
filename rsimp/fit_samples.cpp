// SPDX-License-Identifier: MIT
#include "rsimp/fit_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cluster/cell_sums.h"
#include "ooc/spool_cache.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cell_means.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellRecord;
using cluster::CellTriple;

double sign_of(double x) {
    return x < 0 ? -1 : 1;
}

// Parts of a triangle along an edge, at most.
constexpr double kMostParts = 16;

/// Samples of the parts of large triangles, beyond one for each triangle of a block.
std::size_t most_more_samples(std::size_t n_faces) {
    return 2 * n_faces + 4096;
}

void sort_by_median(std::vector<CellTriple>& faces) {
    std::sort(faces.begin(), faces.end(), [](const CellTriple& a, const CellTriple& b) {
        const std::uint32_t middle_a = cluster::median_corner(a);
        const std::uint32_t middle_b = cluster::median_corner(b);
        return middle_a != middle_b ? middle_a < middle_b : a < b;
    });
}

/// A triangle, its area, and the samples that stand for it.
class SampledTriangle {
  public:
    SampledTriangle(const Vec3& a, const Vec3& b, const Vec3& c) : a_(a), ab_(b - a), ac_(c - a) {
        const Vec3 n = cross(ab_, ac_);
        const double length = std::sqrt(dot(n, n));
        area_ = 0.5 * length;
        if (length > 0) normal_ = (1 / length) * n;
    }
    [[nodiscard]] double area() const { return area_; }

    /// The centres of n * n parts of one size.
    void append(std::size_t n, std::vector<FitSample>& samples) const {
        const double step = 1.0 / static_cast<double>(n);
        const double area = area_ * step * step;
        const auto add = [&](double u, double v) {
            samples.emplace_back(a_ + (u * step) * ab_ + (v * step) * ac_, normal_, area);
        };
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; i + j < n; ++j) {
                const auto u = static_cast<double>(i);
                const auto v = static_cast<double>(j);
                add(u + 1.0 / 3, v + 1.0 / 3);
                if (i + j + 1 < n) add(u + 2.0 / 3, v + 2.0 / 3);
            }
        }
    }

  private:
    Vec3 a_;
    Vec3 ab_;
    Vec3 ac_;
    Vec3 normal_{};
    double area_ = 0;
};

std::vector<FitSample> samples_of(const CellBlocks& cells, std::size_t block,
                                  const SampleChoice& choice) {
    const std::uint64_t first = cells.blocks[block].first_face;
    std::vector<CellTriple> faces(cells.blocks[block + 1].first_face - first);
    cells.faces.read(first, faces);
    CellMeans means(cells, block);
    const double scale = cluster::FixedPoint(cells.grid.resolution()).scale;
    std::vector<std::array<std::int64_t, 3>> normals(means.size());
    // The order of the faces is the threads'; ids are in Morton order. Normals add up exactly.
    std::vector<CellTriple> sampled;
    for (CellTriple face : faces) {
        // From the lowest corner on, so that it does not matter which one comes first.
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        const Vec3 a = means.at(face[0]);
        const Vec3 b = means.at(face[1]);
        const Vec3 c = means.at(face[2]);
        const Vec3 n = cross(b - a, c - a);
        const double length = std::sqrt(dot(n, n));
        if (!(length > 0)) continue;
        for (const std::uint32_t cell : face) {
            if (!means.has(cell)) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                normals[cell - means.first()][k] += cluster::round_to_int(scale * n[k]);
            }
        }
        if (choice.of_all_triangles || 0.5 * length > choice.largest_area) sampled.push_back(face);
    }
    sort_by_median(sampled);
    std::vector<FitSample> samples;
    std::size_t n_more = most_more_samples(faces.size());
    for (const CellTriple& face : sampled) {
        const SampledTriangle triangle(means.at(face[0]), means.at(face[1]), means.at(face[2]));
        const auto wanted = static_cast<std::size_t>(
            std::ceil(std::min(kMostParts, std::sqrt(triangle.area() / choice.largest_area))));
        const std::size_t n = wanted * wanted <= n_more ? std::max<std::size_t>(1, wanted) : 1;
        n_more -= n * n - 1;
        triangle.append(n, samples);
    }
    if (choice.of_all_triangles) return samples;
    for (std::uint64_t i = 0; i < means.size(); ++i) {
        Vec3 normal;
        for (std::size_t k = 0; k < 3; ++k) normal[k] = static_cast<double>(normals[i][k]);
        const double length = std::sqrt(dot(normal, normal));
        const std::uint64_t cell = means.first() + i;
        if (!(length > 0) || !(means.area(cell) > 0)) continue;
        samples.emplace_back(means.at(cell), (1 / length) * normal, means.area(cell));
    }
    return samples;
}

}  // namespace

FitSample::FitSample(const Vec3& position, const Vec3& normal, double area) : place{}, front{} {
    for (std::size_t k = 0; k < 3; ++k) {
        place[k] = static_cast<std::uint32_t>(
            std::llround(std::max(0.0, position[k]) * (1U << kPlaceBits)));
    }
    constexpr std::uint32_t kLeast = 1;  // subnormal, but above 0
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(static_cast<float>(area)) >> 16;
    area_bits = static_cast<std::uint16_t>(std::max(bits, kLeast));
    const double sum = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
    double x = normal[0] / sum;
    double y = normal[1] / sum;
    if (normal[2] < 0) {
        const double folded = (1 - std::abs(y)) * sign_of(x);
        y = (1 - std::abs(x)) * sign_of(y);
        x = folded;
    }
    front = {static_cast<std::int8_t>(std::lround(127 * x)),
             static_cast<std::int8_t>(std::lround(127 * y))};
}

Vec3 FitSample::normal() const {
    constexpr double kUnit = 1 / 127.0;
    double x = kUnit * front[0];
    double y = kUnit * front[1];
    const double z = 1 - std::abs(x) - std::abs(y);
    if (z < 0) {
        const double unfolded = (1 - std::abs(y)) * sign_of(x);
        y = (1 - std::abs(x)) * sign_of(y);
        x = unfolded;
    }
    const double per_length = 1 / std::sqrt(x * x + y * y + z * z);
    return {x * per_length, y * per_length, z * per_length};
}

ooc::Spool<FitSample> collect_samples(ooc::Context& context, const CellBlocks& cells,
                                      const SampleChoice& choice) {
    ooc::Spool<FitSample> samples(context, "samples of the surface");
    const LargestBlock largest(cells);
    const BlocksInFlight in_flight(
        context, "samples of a block",
        largest.n_cells * (sizeof(CellRecord) + sizeof(std::uint64_t) + 2 * sizeof(Vec3) +
                           sizeof(float) + sizeof(FitSample)) +
            largest.n_faces * (2 * sizeof(CellTriple) + sizeof(FitSample)) +
            most_more_samples(largest.n_faces) * sizeof(FitSample) +
            2 * ooc::SpoolCache<CellRecord>::kBytes);
    in_flight.sweep<std::vector<FitSample>>(
        cells.n_blocks(),
        [&](std::uint64_t b, std::vector<FitSample>& piece) {
            piece = samples_of(cells, b, choice);
        },
        [&](std::uint64_t, const std::vector<FitSample>& piece) { samples.append(piece); });
    return samples;
}

}  // namespace hewer::rsimp
