// SPDX-License-Identifier: MIT
#include "rsimp/attribute_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "ooc/spool_cache.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"

namespace hewer::rsimp {

using cluster::AttributeQuadric;
using cluster::CellAttributeQuadric;
using cluster::CellAttributes;
using cluster::CellBlocks;
using cluster::CellRecord;
using cluster::CellTriple;

namespace {

using Values = std::array<double, cluster::kFittedAttributes>;
using Slopes = std::array<Vec3, cluster::kFittedAttributes>;

// Squared length, in cells, that slopes are damped with: those across a needle, thinner than that,
// would be steeper than anything that a vertex could follow.
constexpr double kDamping = 0.01;

Values values_of(const CellAttributes& a, const AttributeScales& scales) {
    Values values{};
    if (scales.color > 0 && a.n_colors > 0) {
        constexpr double kFull = 65535;
        const double unit = scales.color / (kFull * static_cast<double>(a.n_colors));
        for (std::size_t k = 0; k < 3; ++k) values[k] = unit * static_cast<double>(a.color[k]);
    }
    if (scales.normal > 0) {
        const Vec3 n{static_cast<double>(a.normal[0]), static_cast<double>(a.normal[1]),
                     static_cast<double>(a.normal[2])};
        const double length = std::sqrt(dot(n, n));
        for (std::size_t k = 0; k < 3 && length > 0; ++k) {
            values[3 + k] = scales.normal / length * n[k];
        }
    }
    return values;
}

struct Corner {
    Vec3 mean{};  ///< in the block's frame
    Values values{};
};

Corner make_corner(std::uint64_t code, const CellRecord& cell, const CellAttributes& attributes,
                   const Vec3& frame, const AttributeScales& scales) {
    const Vec3 in_cell{static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
                       static_cast<double>(cell.mean[2])};
    return {cluster::center_of(code) - frame + in_cell, values_of(attributes, scales)};
}

/// Cells of other blocks.
class Outside {
  public:
    Outside(const CellBlocks& blocks, const Vec3& frame, const AttributeScales& scales)
        : codes_(blocks.codes),
          cells_(blocks.cells),
          attributes_(blocks.attributes),
          frame_(frame),
          scales_(scales) {}
    Corner at(std::uint32_t cell) {
        return make_corner(codes_.at(cell), cells_.at(cell), attributes_.at(cell), frame_, scales_);
    }
    static constexpr std::uint64_t kBytes = 3 * ooc::SpoolCache<std::uint64_t>::kBytes;

  private:
    ooc::SpoolCache<std::uint64_t> codes_;
    ooc::SpoolCache<CellRecord> cells_;
    ooc::SpoolCache<CellAttributes> attributes_;
    Vec3 frame_;
    const AttributeScales& scales_;
};

/// Slopes in the plane of the triangle: least squares on its edges, with a little damping.
Slopes slopes_of(const std::array<Corner, 3>& t) {
    const Vec3 e1 = t[1].mean - t[0].mean;
    const Vec3 e2 = t[2].mean - t[0].mean;
    // Of the normal equations over the plane, (E E' + damping) y = differences, slope = E' y.
    const double a = dot(e1, e1) + kDamping;
    const double b = dot(e1, e2);
    const double c = dot(e2, e2) + kDamping;
    const double r = 1 / (a * c - b * b);
    Slopes slopes;
    for (std::size_t j = 0; j < slopes.size(); ++j) {
        const double d1 = t[1].values[j] - t[0].values[j];
        const double d2 = t[2].values[j] - t[0].values[j];
        slopes[j] = (r * (c * d1 - b * d2)) * e1 + (r * (a * d2 - b * d1)) * e2;
    }
    return slopes;
}

/// One block's cells and triangles, and what they come to.
struct BlockFit {
    std::vector<CellRecord> cells;
    std::vector<std::uint64_t> codes;
    std::vector<CellAttributes> attributes;
    std::vector<CellTriple> faces;
    std::vector<AttributeQuadric> sums;
    std::vector<CellAttributeQuadric> quadrics;

    static std::uint64_t bytes_for(const LargestBlock& largest) {
        return largest.n_cells *
                   (sizeof(CellRecord) + sizeof(std::uint64_t) + sizeof(CellAttributes) +
                    sizeof(AttributeQuadric) + sizeof(CellAttributeQuadric)) +
               largest.n_faces * sizeof(CellTriple) + Outside::kBytes;
    }

    void load(const CellBlocks& blocks, std::size_t b) {
        const std::uint64_t first = blocks.blocks[b].first_cell;
        const std::uint64_t n = blocks.blocks[b + 1].first_cell - first;
        cells.resize(n);
        blocks.cells.read(first, std::span(cells));
        codes.resize(n);
        blocks.codes.read(first, std::span(codes));
        attributes.resize(n);
        blocks.attributes.read(first, std::span(attributes));
        const std::uint64_t first_face = blocks.blocks[b].first_face;
        faces.resize(blocks.blocks[b + 1].first_face - first_face);
        blocks.faces.read(first_face, std::span(faces));
        for (CellTriple& face : faces) std::sort(face.begin(), face.end());
        std::sort(faces.begin(), faces.end());
        faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    }

    void run(const CellBlocks& blocks, std::size_t b, const AttributeScales& scales) {
        load(blocks, b);
        const std::uint64_t first = blocks.blocks[b].first_cell;
        const std::uint64_t n = cells.size();
        const Vec3 frame = cluster::center_of(codes[n / 2]);
        const auto corner_at = [&](std::uint64_t i) {
            return make_corner(codes[i], cells[i], attributes[i], frame, scales);
        };
        std::optional<Outside> outside;
        sums.assign(n, {});
        for (const CellTriple& face : faces) {
            std::array<Corner, 3> corners;
            for (std::size_t k = 0; k < 3; ++k) {
                if (face[k] >= first && face[k] < first + n) {
                    corners[k] = corner_at(face[k] - first);
                    continue;
                }
                if (!outside) outside.emplace(blocks, frame, scales);
                corners[k] = outside->at(face[k]);
            }
            add_face(face, corners, first);
        }
        quadrics.clear();
        for (std::uint64_t i = 0; i < n; ++i) {
            AttributeQuadric& sum = sums[i];
            if (sum.weight > 0) sum *= static_cast<double>(cells[i].area) / sum.weight;
            quadrics.emplace_back(sum);
        }
    }

  private:
    /// To the sums of those corners that are in the block, each relative to its cell's mean.
    void add_face(const CellTriple& face, const std::array<Corner, 3>& corners,
                  std::uint64_t first) {
        const Vec3 normal =
            cross(corners[1].mean - corners[0].mean, corners[2].mean - corners[0].mean);
        const double area = std::sqrt(dot(normal, normal));
        if (!(area > 0)) return;
        const Slopes slopes = slopes_of(corners);
        const Vec3 middle = (1.0 / 3) * (corners[0].mean + corners[1].mean + corners[2].mean);
        for (std::size_t k = 0; k < 3; ++k) {
            if (face[k] < first || face[k] >= first + cells.size()) continue;
            Values levels;
            for (std::size_t j = 0; j < levels.size(); ++j) {
                const double mean =
                    (corners[0].values[j] + corners[1].values[j] + corners[2].values[j]) / 3;
                levels[j] = mean + dot(slopes[j], corners[k].mean - middle);
            }
            sums[face[k] - first].add_piece(area, slopes, levels);
        }
    }
};

}  // namespace

void fit_attributes(ooc::Context& context, const AttributeScales& scales, CellBlocks& blocks) {
    blocks.attribute_quadrics = {context, "attribute quadrics of cells"};
    const BlocksInFlight in_flight(context, "attribute quadrics of a block",
                                   BlockFit::bytes_for(LargestBlock(blocks)));
    in_flight.sweep<BlockFit>(
        blocks.n_blocks(), [&](std::uint64_t b, BlockFit& block) { block.run(blocks, b, scales); },
        [&](std::uint64_t, const BlockFit& block) {
            blocks.attribute_quadrics.append(block.quadrics);
        });
}

}  // namespace hewer::rsimp
