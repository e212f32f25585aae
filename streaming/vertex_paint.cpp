// SPDX-License-Identifier: MIT
#include "streaming/vertex_paint.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "ooc/array.h"
#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "streaming/block_pool.h"
#include "streaming/vertex_cache.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kBatch = 2048;
constexpr std::uint64_t kPiece = 16384;
constexpr std::uint64_t kMostLines = 1 << 14;  // of tiles, for each thread: 48 MiB
// Coordinates beyond are no places in an image: a texel is less than their last bit.
constexpr double kMostCoordinate = 0x1p31;
// Triangles without area count where a vertex has no others.
constexpr double kLeastWeight = 1e-200;

/// What a corner brings to its vertex.
struct Contribution {
    std::uint64_t vertex;
    MeanColor color;
    double weight;
};

/// Of weighted colours.
struct ColorSum {
    std::array<double, 3> color;
    double weight;
};

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    return 0.5 * std::sqrt(dot(n, n));
}

/// How the memory that is free is shared out: by the limit, which changes the time only.
struct Shares {
    std::uint64_t n_vertices;      // of a pass
    std::uint64_t position_bytes;  // for each thread
    std::uint64_t texcoord_bytes;
    std::uint64_t n_tile_lines;

    Shares(ooc::Context& context, const PaintedMesh& mesh, const TextureSet& textures) {
        const std::uint64_t free = context.budget().available();
        n_vertices = std::clamp<std::uint64_t>(free / 4 / sizeof(ColorSum),
                                               std::min(kPiece, mesh.n_vertices), mesh.n_vertices);
        const std::uint64_t each = free / 2 / context.n_threads();
        position_bytes = std::min(each / 4, 2 * sizeof(Vec3) * mesh.n_vertices);
        texcoord_bytes = std::min(each / 4, 4 * sizeof(float) * mesh.n_texcoords);
        const std::uint64_t lines =
            std::min({each / 2 / TexelCache::kLineBytes, 2 * textures.tiles().size(), kMostLines});
        n_tile_lines = std::bit_floor(std::max(TexelCache::kLeastLines, lines));
    }
};

/// One thread's way from triangles to what their corners bring.
class Painter {
  public:
    Painter(ooc::Context& context, const PaintedMesh& mesh, const TextureSet& textures,
            const Shares& shares)
        : mesh_(mesh),
          textures_(textures),
          positions_(context, mesh.n_vertices, mesh.load_positions, shares.position_bytes),
          texcoords_(context, mesh.n_texcoords, mesh.load_texcoords, shares.texcoord_bytes),
          texels_(context.budget(), textures.tiles(), shares.n_tile_lines),
          filter_(texels_) {}

    /// For the vertices from `first` up to `last`.
    void paint(std::span<const PaintedTriangle> triangles, std::uint64_t first, std::uint64_t last,
               std::vector<Contribution>& out) {
        for (const PaintedTriangle& t : triangles) {
            const auto& v = t.corners;
            if (t.paint >= mesh_.paints.size() ||
                std::max({v[0], v[1], v[2]}) >= mesh_.n_vertices ||
                std::none_of(v.begin(), v.end(),
                             [&](std::uint64_t id) { return id >= first && id < last; })) {
                continue;
            }
            const auto colors = colors_of(t);
            if (!colors) continue;
            const std::array<Vec3, 3> p{positions_.at(v[0]), positions_.at(v[1]),
                                        positions_.at(v[2])};
            if (!is_finite(p[0]) || !is_finite(p[1]) || !is_finite(p[2])) continue;
            const double weight = std::max(area_of(p[0], p[1], p[2]), kLeastWeight);
            if (!std::isfinite(weight)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                if (v[c] >= first && v[c] < last) out.push_back({v[c], (*colors)[c], weight});
            }
        }
    }

  private:
    std::optional<std::array<MeanColor, 3>> colors_of(const PaintedTriangle& t) {
        const Paint& paint = mesh_.paints[t.paint];
        if (paint.texture) {
            std::array<TexCoord, 3> places;
            if (find_places(t, paint, places)) {
                return filter_.corner_means(textures_[*paint.texture], places, paint.wrap);
            }
        }
        if (!paint.color) return {};
        return std::array<MeanColor, 3>{*paint.color, *paint.color, *paint.color};
    }

    bool find_places(const PaintedTriangle& t, const Paint& paint,
                     std::array<TexCoord, 3>& places) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (t.texcoords[c] >= mesh_.n_texcoords) return false;
            const std::array<float, 2> uv = texcoords_.at(t.texcoords[c]);
            for (std::size_t k = 0; k < 2; ++k) {
                const auto& row = paint.to_image[k];
                places[c][k] = row[0] * static_cast<double>(uv[0]) +
                               row[1] * static_cast<double>(uv[1]) + row[2];
                if (!(std::abs(places[c][k]) < kMostCoordinate)) return false;
            }
        }
        return true;
    }

    const PaintedMesh& mesh_;
    const TextureSet& textures_;
    VertexCache<Vec3> positions_;
    VertexCache<std::array<float, 2>> texcoords_;
    TexelCache texels_;
    TextureFilter filter_;
};

void add(const std::vector<Contribution>& found, std::uint64_t first, ooc::Array<ColorSum>& sums) {
    for (const Contribution& c : found) {
        ColorSum& sum = sums[c.vertex - first];
        for (std::size_t k = 0; k < 3; ++k) {
            sum.color[k] += c.weight * static_cast<double>(c.color[k]);
        }
        sum.weight += c.weight;
    }
}

VertexColor mean(const ColorSum& sum) {
    if (!(sum.weight > 0)) return {};
    MeanColor color;
    for (std::size_t k = 0; k < 3; ++k) {
        color[k] = static_cast<float>(sum.color[k] / sum.weight);
    }
    return color;
}

}  // namespace

Rgba16 to_rgba(const MeanColor& color) {
    Rgba16 result{65535, 65535, 65535, 65535};
    for (std::size_t k = 0; k < 3; ++k) {
        result[k] = static_cast<std::uint16_t>(std::lround(color[k] * 65535.0F));
    }
    return result;
}

void paint_vertices(ooc::Context& context, const PaintedMesh& mesh, const TextureSet& textures,
                    const std::function<void(std::span<const VertexColor>)>& take) {
    const Shares shares(context, mesh, textures);
    ooc::Array<ColorSum> sums(context.budget(), "colours of vertices", shares.n_vertices);
    const std::uint64_t n_batches = (mesh.n_triangles + kBatch - 1) / kBatch;
    struct Work {
        std::unique_ptr<Painter> painter;
        std::vector<PaintedTriangle> triangles;
    };
    const std::uint64_t most_in_flight = 2 * context.n_threads();
    const ooc::Reservation memory = context.budget().reserve(
        "triangles that are being painted",
        most_in_flight * kBatch * (3 * sizeof(Contribution) + sizeof(PaintedTriangle)));
    BlockPool<Work> pool;
    std::vector<VertexColor> colors;
    for (std::uint64_t first = 0; first < mesh.n_vertices; first += sums.size()) {
        const std::uint64_t last = std::min(first + sums.size(), mesh.n_vertices);
        std::fill(sums.begin(), sums.end(), ColorSum{});
        context.workers().in_order(
            n_batches, most_in_flight,
            [&](std::uint64_t i) {
                const auto work = pool.lease();
                if (!work->painter) {
                    work->painter = std::make_unique<Painter>(context, mesh, textures, shares);
                }
                work->triangles.resize(std::min(kBatch, mesh.n_triangles - i * kBatch));
                mesh.read_triangles(i * kBatch, work->triangles);
                std::vector<Contribution> found;
                work->painter->paint(work->triangles, first, last, found);
                context.check_stop();
                return found;
            },
            [&](std::uint64_t, const std::vector<Contribution>& found) {
                add(found, first, sums);
            });
        for (std::uint64_t v = first; v < last; v += kPiece) {
            colors.clear();
            for (std::uint64_t i = v; i < std::min(v + kPiece, last); ++i) {
                colors.push_back(mean(sums[i - first]));
            }
            take(colors);
        }
    }
}

}  // namespace hewer::streaming
