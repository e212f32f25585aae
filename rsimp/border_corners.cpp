// SPDX-License-Identifier: MIT
#include "rsimp/border_corners.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "cluster/make_record.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cell_means.h"

namespace hewer::rsimp {

using cluster::CellBlocks;
using cluster::CellRecord;
using cluster::CellTriple;

namespace {

/// An edge at a border cell of the block, as a triangle goes along it.
struct EdgeEnd {
    std::uint32_t cell;   ///< place in the block
    std::uint32_t other;  ///< id
    std::int32_t n;       ///< how often it leaves the cell, less how often it arrives
};

struct BlockCorners {
    std::vector<CellRecord> cells;
    std::vector<CellTriple> faces;
    std::vector<EdgeEnd> ends;

    static std::uint64_t bytes_for(const LargestBlock& largest) {
        return largest.n_cells * (sizeof(CellRecord) + CellMeans::kBytesPerCell) +
               largest.n_faces * (sizeof(CellTriple) + 6 * sizeof(EdgeEnd)) +
               CellMeans::kCacheBytes;
    }

    void run(const CellBlocks& blocks, std::size_t b, double weight) {
        const std::uint64_t first = blocks.blocks[b].first_cell;
        const std::uint64_t n = blocks.blocks[b + 1].first_cell - first;
        cells.resize(n);
        blocks.cells.read(first, std::span(cells));
        if (std::none_of(cells.begin(), cells.end(), is_border)) return;
        const std::uint64_t first_face = blocks.blocks[b].first_face;
        faces.resize(blocks.blocks[b + 1].first_face - first_face);
        blocks.faces.read(first_face, std::span(faces));
        gather_ends(first);
        CellMeans means(blocks, b);
        hold(means, weight);
    }

  private:
    static bool is_border(const CellRecord& cell) {
        return (cell.flags & CellRecord::kHasBorder) != 0;
    }

    /// Edges that a triangle goes along each way cancel.
    void gather_ends(std::uint64_t first) {
        ends.clear();
        for (const CellTriple& face : faces) {
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint64_t i = face[k] - first;  // wraps around for lower cells
                if (i >= cells.size() || !is_border(cells[i])) continue;
                const auto cell = static_cast<std::uint32_t>(i);
                ends.push_back({cell, face[(k + 1) % 3], 1});
                ends.push_back({cell, face[(k + 2) % 3], -1});
            }
        }
        std::sort(ends.begin(), ends.end(), [](const EdgeEnd& a, const EdgeEnd& b) {
            return std::tie(a.cell, a.other) < std::tie(b.cell, b.other);
        });
        std::size_t n = 0;
        for (const EdgeEnd& end : ends) {
            if (n > 0 && ends[n - 1].cell == end.cell && ends[n - 1].other == end.other) {
                if ((ends[n - 1].n += end.n) == 0) --n;
            } else {
                ends[n++] = end;
            }
        }
        ends.resize(n);
    }

    void hold(CellMeans& means, double weight) {
        for (std::size_t i = 0; i < ends.size();) {
            std::size_t j = i + 1;
            while (j < ends.size() && ends[j].cell == ends[i].cell) ++j;
            if (j == i + 2 && ends[i].n * ends[i + 1].n == -1) {
                const Vec3 here = means.at(means.first() + ends[i].cell);
                hold_corner(cells[ends[i].cell], means.at(ends[i].other) - here,
                            means.at(ends[i + 1].other) - here, weight);
            }
            i = j;
        }
    }

    static void hold_corner(CellRecord& cell, const Vec3& d, const Vec3& e, double weight) {
        const Vec3 chord = e - d;
        const double cc = dot(chord, chord);
        if (!(cc > 0)) return;  // a border that turns back: no chord either
        const Vec3 twice_area = cross(d, e);
        const double held = weight * dot(twice_area, twice_area) / (cc * cc);  // h^2 / |chord|^2
        std::size_t at = 0;
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = r; c < 3; ++c) {
                cell.quadric[at++] += static_cast<float>(held * chord[r] * chord[c]);
            }
        }
    }
};

}  // namespace

void hold_border_corners(ooc::Context& context, double border_weight, CellBlocks& blocks) {
    if (blocks.n_border_cells == 0 || !blocks.is_consistently_wound || !(border_weight > 0)) return;
    ooc::Spool<CellRecord> held(context, "cells");
    const BlocksInFlight in_flight(context, "the border corners of a block",
                                   BlockCorners::bytes_for(LargestBlock(blocks)));
    in_flight.sweep<BlockCorners>(
        blocks.n_blocks(),
        [&](std::uint64_t b, BlockCorners& block) {
            block.run(blocks, b, kHeldShare * cluster::kBorderScale * border_weight);
        },
        [&](std::uint64_t, const BlockCorners& block) { held.append(block.cells); });
    blocks.cells = std::move(held);
}

}  // namespace hewer::rsimp
