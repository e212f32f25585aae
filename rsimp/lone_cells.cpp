// SPDX-License-Identifier: MIT
#include <atomic>
#include <optional>
#include <vector>

#include "cluster/code_lookup.h"
#include "ooc/array.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellTriple;

/// A bit for each cell that a surviving triangle has a corner in.
class FacedCells {
  public:
    FacedCells(ooc::Context& context, const CellBlocks& cells)
        : bits_(context.budget(), "cells with faces", (cells.n_cells() + 63) / 64) {
        context.workers().for_ranges(
            cells.n_blocks(), 1, [&](std::uint64_t first, std::uint64_t last) {
                ooc::SpoolReader<CellTriple> faces(cells.faces, cells.blocks[first].first_face,
                                                   cells.blocks[last].first_face);
                for (auto piece = faces.next_piece(); !piece.empty(); piece = faces.next_piece()) {
                    for (const CellTriple& face : piece) {
                        for (const std::uint32_t cell : face) mark(cell);
                    }
                }
                context.check_stop();
            });
    }
    [[nodiscard]] bool has(std::uint64_t cell) const {
        return (bits_[cell / 64] >> (cell % 64) & 1) != 0;
    }

  private:
    void mark(std::uint64_t cell) {
        const std::atomic_ref<std::uint64_t> word(bits_[cell / 64]);
        const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
        if ((word.load(std::memory_order_relaxed) & bit) == 0) {
            word.fetch_or(bit, std::memory_order_relaxed);
        }
    }
    ooc::Array<std::uint64_t> bits_;
};

/// visit(code) for the up to 26 cells around one until it returns true.
template <typename Visit>
bool any_neighbour(std::uint64_t code, const Visit& visit) {
    constexpr std::uint32_t kMost = (1U << 21) - 1;
    const auto c = cluster::unpack_morton(code);
    for (std::uint32_t i = 0; i < 27; ++i) {
        // Each axis by 0, +1, -1.
        const std::array<std::uint32_t, 3> step{i % 3, i / 3 % 3, i / 9};
        std::array<std::uint32_t, 3> n{};
        bool is_there = i != 0;
        for (std::size_t k = 0; k < 3; ++k) {
            is_there = is_there && (step[k] != 1 || c[k] < kMost) && (step[k] != 2 || c[k] > 0);
            n[k] = step[k] == 2 ? c[k] - 1 : c[k] + step[k];
        }
        if (!is_there) continue;
        if (visit(cluster::spread_bits(n[0]) | cluster::spread_bits(n[1]) << 1 |
                  cluster::spread_bits(n[2]) << 2)) {
            return true;
        }
    }
    return false;
}

}  // namespace

void find_lone_cells(ooc::Context& context, const CellBlocks& cells, const Vec3& origin,
                     ooc::Spool<LostPart>& lost) {
    const FacedCells faced(context, cells);
    struct Work {
        std::optional<cluster::CodeLookup> lookup;
        std::vector<std::uint64_t> codes;
        std::vector<LostPart> parts;
    };
    const BlocksInFlight in_flight(
        context, "codes of a block",
        LargestBlock(cells).n_cells * sizeof(std::uint64_t) * (1 + cluster::CodeLookup::kBlocks));
    in_flight.sweep<Work>(
        cells.n_blocks(),
        [&](std::uint64_t b, Work& work) {
            if (!work.lookup) work.lookup.emplace(cells);
            const std::uint64_t first = cells.blocks[b].first_cell;
            work.codes.resize(cells.blocks[b + 1].first_cell - first);
            cells.codes.read(first, work.codes);
            work.parts.clear();
            for (std::uint64_t i = 0; i < work.codes.size(); ++i) {
                if (faced.has(first + i)) continue;
                const auto has_face = [&](std::uint64_t code) {
                    const auto id = work.lookup->find(code);
                    return id && faced.has(*id);
                };
                if (any_neighbour(work.codes[i], has_face)) continue;
                const Vec3 center = cluster::center_of(work.codes[i]) - origin;
                LostPart& part = work.parts.emplace_back(LostPart{{}, 1, 1});
                for (std::size_t k = 0; k < 3; ++k) {
                    part.box[k] = static_cast<float>(center[k] - 0.5);
                    part.box[3 + k] = static_cast<float>(center[k] + 0.5);
                }
            }
        },
        [&](std::uint64_t, const Work& work) { append_lost(context, work.parts, lost); });
}

}  // namespace hewer::rsimp
