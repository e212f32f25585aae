// SPDX-License-Identifier: MIT
#include "rsimp/cell_selection.h"

#include <optional>
#include <vector>

#include "cluster/block_cutter.h"

namespace hewer::rsimp {

using cluster::CellAttributes;
using cluster::CellBlocks;
using cluster::CellRecord;

void copy_cells(ooc::Context& context, CellBlocks& from, const ooc::RankedSet& kept,
                const ChangeCell& change, std::uint64_t most_cells, CellBlocks& to) {
    cluster::BlockCutter cutter(to, most_cells);
    ooc::SpoolReader<std::uint64_t> codes(from.codes);
    ooc::SpoolReader<CellRecord> records(from.cells);
    ooc::SpoolReader<CellAttributes> attributes(from.attributes);
    constexpr std::uint64_t kPiece = 1 << 13;
    std::vector<std::uint64_t> piece;
    const std::uint64_t n = from.n_cells();
    for (std::uint64_t i = 0; i < n; ++i) {
        const std::uint64_t code = *codes.next();
        CellRecord record = *records.next();
        const CellAttributes* const given = attributes.next();
        if (kept.has(i)) {
            std::optional<CellAttributes> a;
            if (given != nullptr) a = *given;
            if (change) change(i, record, a ? &*a : nullptr);
            piece.push_back(code);
            to.cells.push(record);
            if (a) to.attributes.push(*a);
            if ((record.flags & CellRecord::kHasBorder) != 0) ++to.n_border_cells;
        }
        if (piece.size() < kPiece && i + 1 < n) continue;
        cutter.add(piece);
        piece.clear();
        from.cells.discard_before(i + 1);
        if (!from.attributes.empty()) from.attributes.discard_before(i + 1);
        context.check_stop();
    }
    cutter.finish();
}

void copy_borders(const CellBlocks& from, const ooc::RankedSet& kept, CellBlocks& to) {
    ooc::SpoolReader<cluster::BorderLine> lines(from.borders);
    while (const cluster::BorderLine* line = lines.next()) {
        if (!kept.has(line->cell)) continue;
        cluster::BorderLine copy = *line;
        copy.cell = static_cast<std::uint32_t>(kept.rank(line->cell));
        to.borders.push(copy);
    }
}

}  // namespace hewer::rsimp
