// SPDX-License-Identifier: MIT
#include <optional>
#include <vector>

#include "rsimp/blocks_in_flight.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

void find_lone_cells(ooc::Context& context, const cluster::CellBlocks& cells, const Vec3& origin,
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
