// SPDX-License-Identifier: MIT
#include "rsimp/drop_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include "hewer/error.h"
#include "ooc/array.h"
#include "ooc/vec3.h"
#include "rsimp/cell_mean.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/cell_parts.h"
#include "rsimp/cell_selection.h"
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
        const Vec3 mean = mean_of(*codes.next(), *records.next());
        const std::uint32_t piece = *pieces.next();
        if (!faced.has(i)) continue;
        PartBox& box = boxes[parts.part_of(piece)];
        for (std::size_t k = 0; k < 3; ++k) {
            box.low[k] = box.n_cells == 0 ? mean[k] : std::min(box.low[k], mean[k]);
            box.high[k] = box.n_cells == 0 ? mean[k] : std::max(box.high[k], mean[k]);
        }
        ++box.n_cells;
    }
    return boxes;
}

/// A cell without a face goes if what is around it goes: a part grazed it.
ooc::RankedSet choose_cells(ooc::Context& context, const CellBlocks& cells, const FacedCells& faced,
                            const ooc::Array<PartBox>& boxes, CellParts& parts) {
    ooc::RankedSet kept(context.budget(), "cells that stay", cells.n_cells());
    {
        ooc::SpoolReader<std::uint32_t> pieces(parts.pieces());
        for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
            const std::uint32_t piece = *pieces.next();
            if (faced.has(i) && !boxes[parts.part_of(piece)].is_small) kept.insert(i);
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
        if (has_kept || !has_dropped) kept.insert(i);
    }
    kept.number();
    return kept;
}

/// With fewer cells the blocks are the same boxes or larger ones, and ids keep their order: so
/// faces that were in the order of the blocks of their median corners still are.
void copy_faces(ooc::Context& context, CellBlocks& from, const ooc::RankedSet& kept,
                CellBlocks& to) {
    ooc::SpoolReader<CellTriple> faces(from.faces);
    std::size_t block = 0;
    while (const CellTriple* face = faces.next()) {
        if (!kept.has((*face)[0])) continue;
        CellTriple mapped = *face;
        for (std::uint32_t& cell : mapped) cell = static_cast<std::uint32_t>(kept.rank(cell));
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
    sort_places(report.dropped);
    if (report.dropped.places == 0) return cells;
    if (!is_any_kept) {
        std::ostringstream text;
        text << report.input.path << ": every part is smaller than the " << least
             << " that --drop-parts asks for; the largest has a diagonal of " << largest;
        throw InvalidArgument(text.str());
    }
    const ooc::RankedSet kept = choose_cells(context, cells, faced, boxes, parts);
    CellBlocks result = cluster::make_cell_blocks(context, cells.lattice, cells.grid,
                                                  cluster::CellExtras(!cells.attributes.empty()));
    result.is_consistently_wound = cells.is_consistently_wound;
    result.has_vertex_cells = cells.has_vertex_cells;
    copy_cells(context, cells, kept, {}, most_cells, result);
    copy_borders(cells, kept, result);
    copy_faces(context, cells, kept, result);
    return result;
}

}  // namespace hewer::rsimp
