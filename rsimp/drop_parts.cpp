// SPDX-License-Identifier: MIT
#include "rsimp/drop_parts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "cluster/block_cutter.h"
#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/vec3.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/cell_parts.h"
#include "rsimp/grid_choice.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellRecord;
using cluster::CellTriple;

/// Of a part with faces; kept at its first piece.
struct PartBox {
    Vec3 low;
    Vec3 high;
    std::uint64_t n_cells;
    bool is_small;
};

double diagonal(const PartBox& box) {
    const Vec3 d = box.high - box.low;
    return std::sqrt(dot(d, d));
}

/// The boxes of all parts; without cells those that have no face.
ooc::Array<PartBox> find_boxes(ooc::Context& context, const CellBlocks& cells,
                               const FacedCells& faced, CellParts& parts) {
    ooc::Array<PartBox> boxes(context.budget(), "boxes of the parts of the model",
                              parts.n_pieces());
    ooc::SpoolReader<std::uint64_t> codes(cells.codes);
    ooc::SpoolReader<CellRecord> records(cells.cells);
    ooc::SpoolReader<std::uint32_t> pieces(parts.pieces());
    for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
        const Vec3 center = cluster::center_of(*codes.next());
        const CellRecord& record = *records.next();
        const std::uint32_t piece = *pieces.next();
        if (!faced.has(i)) continue;
        PartBox& box = boxes[parts.part_of(piece)];
        const auto beyond = record.mean_beyond();
        for (std::size_t k = 0; k < 3; ++k) {
            const double x = center[k] + static_cast<double>(record.mean[k]) + beyond[k];
            box.low[k] = box.n_cells == 0 ? x : std::min(box.low[k], x);
            box.high[k] = box.n_cells == 0 ? x : std::max(box.high[k], x);
        }
        ++box.n_cells;
    }
    return boxes;
}

/// The cells that stay, and their new ids.
class KeptCells {
  public:
    KeptCells(ooc::MemoryBudget& budget, std::uint64_t n_cells)
        : bits_(budget, "cells that stay", n_cells / kWord + 1),
          before_(budget, "cells that stay", n_cells / kWord + 1) {}
    void keep(std::uint64_t cell) { bits_[cell / kWord] |= std::uint64_t{1} << (cell % kWord); }
    /// After the last keep().
    void number() {
        std::uint32_t n = 0;
        for (std::uint64_t w = 0; w < bits_.size(); ++w) {
            before_[w] = n;
            n += static_cast<std::uint32_t>(std::popcount(bits_[w]));
        }
    }
    [[nodiscard]] bool has(std::uint64_t cell) const {
        return (bits_[cell / kWord] >> (cell % kWord) & 1) != 0;
    }
    /// Precondition: it stays.
    [[nodiscard]] std::uint32_t id(std::uint64_t cell) const {
        const std::uint64_t below = (std::uint64_t{1} << (cell % kWord)) - 1;
        return before_[cell / kWord] +
               static_cast<std::uint32_t>(std::popcount(bits_[cell / kWord] & below));
    }

  private:
    static constexpr std::uint64_t kWord = 64;
    ooc::Array<std::uint64_t> bits_;
    ooc::Array<std::uint32_t> before_;
};

/// A cell without a face goes if what is around it goes: a part grazed it.
KeptCells choose_cells(ooc::Context& context, const CellBlocks& cells, const FacedCells& faced,
                       const ooc::Array<PartBox>& boxes, CellParts& parts) {
    KeptCells kept(context.budget(), cells.n_cells());
    {
        ooc::SpoolReader<std::uint32_t> pieces(parts.pieces());
        for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
            const std::uint32_t piece = *pieces.next();
            if (faced.has(i) && !boxes[parts.part_of(piece)].is_small) kept.keep(i);
        }
    }
    const ooc::Reservation bytes = context.budget().reserve(
        "codes of blocks",
        cluster::CodeLookup::kBlocks * CellBlocks::kMostCells * sizeof(std::uint64_t));
    cluster::CodeLookup lookup(cells);
    ooc::SpoolReader<std::uint64_t> codes(cells.codes);
    for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
        const std::uint64_t code = *codes.next();
        if (faced.has(i)) continue;
        bool has_dropped = false;
        const bool has_kept = any_neighbour(code, [&](std::uint64_t neighbour) {
            const auto id = lookup.find(neighbour);
            if (!id || !faced.has(*id)) return false;
            has_dropped = true;
            return kept.has(*id);
        });
        if (has_kept || !has_dropped) kept.keep(i);
    }
    kept.number();
    return kept;
}

void copy_cells(ooc::Context& context, CellBlocks& from, const KeptCells& kept,
                std::uint64_t most_cells, CellBlocks& to) {
    cluster::BlockCutter cutter(to, most_cells);
    ooc::SpoolReader<std::uint64_t> codes(from.codes);
    ooc::SpoolReader<CellRecord> records(from.cells);
    ooc::SpoolReader<cluster::CellAttributes> attributes(from.attributes);
    constexpr std::uint64_t kPiece = 1 << 13;
    std::vector<std::uint64_t> piece;
    const std::uint64_t n = from.n_cells();
    for (std::uint64_t i = 0; i < n; ++i) {
        const std::uint64_t code = *codes.next();
        const CellRecord& record = *records.next();
        const cluster::CellAttributes* const a = attributes.next();
        if (kept.has(i)) {
            piece.push_back(code);
            to.cells.push(record);
            if (a != nullptr) to.attributes.push(*a);
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

/// With fewer cells the blocks are the same boxes or larger ones, and ids keep their order: so
/// faces that were in the order of the blocks of their median corners still are.
void copy_faces(ooc::Context& context, CellBlocks& from, const KeptCells& kept, CellBlocks& to) {
    ooc::SpoolReader<CellTriple> faces(from.faces);
    std::size_t block = 0;
    while (const CellTriple* face = faces.next()) {
        if (!kept.has((*face)[0])) continue;
        const CellTriple mapped{kept.id((*face)[0]), kept.id((*face)[1]), kept.id((*face)[2])};
        while (cluster::median_corner(mapped) >= to.blocks[block + 1].first_cell) {
            to.blocks[++block].first_face = to.faces.size();
        }
        to.faces.push(mapped);
        constexpr std::uint64_t kBetween = 1 << 16;
        if (faces.position() % kBetween != 0) continue;
        from.faces.discard_before(faces.position());
        context.check_stop();
    }
    while (++block < to.blocks.size()) to.blocks[block].first_face = to.faces.size();
}

}  // namespace

CellBlocks drop_parts(ooc::Context& context, CellBlocks cells, const SimplifyOptions& options,
                      SimplifyReport& report, std::uint64_t most_cells) {
    if (!options.drop_parts) return cells;
    report.dropped = {};
    const double least = target_error(*options.drop_parts, report.input.bounds);
    const double cell_size = cells.grid.cell_size(cells.lattice);
    CellParts parts(context, cells);
    const FacedCells faced(context, cells);
    ooc::Array<PartBox> boxes = find_boxes(context, cells, faced, parts);
    double largest = 0;
    bool is_any_kept = false;
    for (PartBox& box : boxes) {
        if (box.n_cells == 0) continue;
        const double size = cell_size * diagonal(box);
        largest = std::max(largest, size);
        box.is_small = size < least;
        is_any_kept |= !box.is_small;
        if (!box.is_small) continue;
        add_place(report.dropped, {cells.to_model(0.5 * (box.low + box.high)), size, box.n_cells});
    }
    if (report.dropped.places == 0) return cells;
    if (!is_any_kept) {
        std::ostringstream text;
        text << report.input.path << ": every part is smaller than the " << least
             << " that --drop-parts asks for; the largest has a diagonal of " << largest;
        throw InvalidArgument(text.str());
    }
    const KeptCells kept = choose_cells(context, cells, faced, boxes, parts);
    CellBlocks result = cluster::make_cell_blocks(context, cells.lattice, cells.grid,
                                                  cluster::CellExtras(!cells.attributes.empty()));
    result.is_consistently_wound = cells.is_consistently_wound;
    copy_cells(context, cells, kept, most_cells, result);
    copy_faces(context, cells, kept, result);
    return result;
}

}  // namespace hewer::rsimp
