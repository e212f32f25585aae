// SPDX-License-Identifier: MIT
#include "cluster/cell_blocks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "cluster/block_cutter.h"
#include "cluster/make_record.h"
#include "ooc/parallel.h"
#include "ooc/radix_sort.h"

namespace hewer::cluster {

namespace {

struct CodedSlot {
    std::uint64_t code;
    std::uint32_t slot;
    std::uint32_t unused;
};

constexpr std::uint64_t kPiece = 1 << 13;

struct CellCounts {
    std::uint64_t touched = 0;
    std::uint64_t border = 0;
};

CellCounts count_cells(ooc::Context& context, CellTable& table) {
    std::atomic<std::uint64_t> n_touched{0};
    std::atomic<std::uint64_t> n_border{0};
    context.workers().for_ranges(table.size(), kPiece, [&](std::uint64_t b, std::uint64_t e) {
        CellCounts counts;
        for (std::uint64_t slot = b; slot < e; ++slot) {
            const CellSums& sums = table.sums(static_cast<std::uint32_t>(slot));
            if (sums.is_touched == 0) continue;
            ++counts.touched;
            if (has_border(sums)) ++counts.border;
        }
        n_touched += counts.touched;
        n_border += counts.border;
    });
    return {n_touched, n_border};
}

/// The triples by ids, sorted into the blocks of their median corners.
void append_faces(ooc::Context& context, const ooc::Array<std::uint32_t>& rank,
                  std::vector<TripleList>& triples, CellBlocks& blocks) {
    std::uint64_t n = 0;
    for (const TripleList& list : triples) n += list.size();
    ooc::Array<CellTriple> faces(context.budget(), "surviving triangles", n);
    std::uint64_t at = 0;
    for (TripleList& list : triples) {
        for (;;) {
            const auto [piece, used] = list.pop_piece();
            if (used == 0) break;
            const std::uint64_t first = at;
            const auto& source = piece;
            context.workers().for_ranges(used, kPiece, [&](std::uint64_t b, std::uint64_t e) {
                for (std::uint64_t i = b; i < e; ++i) {
                    for (std::size_t k = 0; k < 3; ++k) faces[first + i][k] = rank[source[i][k]];
                }
            });
            at += used;
        }
    }
    // Cells are cut into blocks, so that the block of a cell is found in a small table.
    const std::size_t n_blocks = blocks.n_blocks();
    ooc::Array<std::uint32_t> block_of(context.budget(), "blocks of cells", blocks.n_cells());
    for (std::uint32_t b = 0; b < n_blocks; ++b) {
        std::fill(block_of.begin() + blocks.blocks[b].first_cell,
                  block_of.begin() + blocks.blocks[b + 1].first_cell, b);
    }
    std::vector<std::uint64_t> start(n_blocks + 1);
    for (const CellTriple& face : faces) ++start[block_of[median_corner(face)] + 1];
    for (std::size_t b = 0; b < n_blocks; ++b) start[b + 1] += start[b];
    for (std::size_t b = 0; b <= n_blocks; ++b) blocks.blocks[b].first_face = start[b];
    ooc::Array<CellTriple> sorted(context.budget(), "triangles by block", n);
    for (const CellTriple& face : faces) sorted[start[block_of[median_corner(face)]]++] = face;
    faces.release();
    blocks.faces.append(sorted.span());
}

}  // namespace

CellBlocks build_cell_blocks(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                             CellTable& table, std::vector<TripleList>& triples,
                             double border_weight, std::uint64_t most_cells) {
    CellBlocks blocks = make_cell_blocks(context, lattice, grid, table.extras());
    const FixedPoint fixed(grid.resolution());
    const std::uint64_t n_slots = table.size();
    const CellCounts counts = count_cells(context, table);
    const std::uint64_t n_cells = counts.touched;
    blocks.n_border_cells = counts.border;
    blocks.is_consistently_wound = !is_border_implausible(blocks.n_border_cells, n_cells);
    if (!blocks.is_consistently_wound) border_weight = 0;

    ooc::Array<CodedSlot> order(context.budget(), "cell order", n_cells);
    std::uint64_t i = 0;
    table.for_each([&](CellKey key, std::uint32_t slot) {
        // Most often no vertex is unused: no need to look.
        if (n_cells != n_slots && table.sums(slot).is_touched == 0) return;
        order[i++] = {morton(key), slot, 0};
    });
    table.release_index();
    {
        ooc::Array<CodedSlot> scratch(context.budget(), "cell order", n_cells);
        ooc::radix_sort(order, scratch, [](const CodedSlot& s) { return s.code; });
    }
    {
        BlockCutter cutter(blocks, most_cells);
        ooc::Array<std::uint32_t> rank(context.budget(), "cell ranks", n_slots);
        std::vector<std::uint64_t> codes;
        for (std::uint64_t k = 0; k < n_cells; ++k) {
            rank[order[k].slot] = static_cast<std::uint32_t>(k);
            codes.push_back(order[k].code);
            if (codes.size() == kPiece) {
                cutter.add(codes);
                codes.clear();
            }
        }
        cutter.add(codes);
        cutter.finish();
        append_faces(context, rank, triples, blocks);
    }
    struct Piece {
        std::vector<CellRecord> cells;
        std::vector<CellAttributes> attributes;
        std::vector<BorderLine> borders;
        std::vector<float> weights;
    };
    context.workers().in_order(
        (n_cells + kPiece - 1) / kPiece, 2 * context.n_threads(),
        [&](std::uint64_t p) {
            Piece piece;
            const std::uint64_t end = std::min(n_cells, (p + 1) * kPiece);
            piece.cells.reserve(end - p * kPiece);
            if (table.extras().attributes) piece.attributes.reserve(end - p * kPiece);
            for (std::uint64_t k = p * kPiece; k < end; ++k) {
                const std::uint32_t slot = order[k].slot;
                const CellSums& sums = table.sums(slot);
                piece.cells.push_back(make_record(sums, fixed, border_weight));
                if (blocks.is_consistently_wound) {
                    auto line =
                        border_line(sums, fixed, piece.cells.back(), center_of(order[k].code));
                    if (line) {
                        line->cell = static_cast<std::uint32_t>(k);
                        piece.borders.push_back(*line);
                    }
                }
                if (table.extras().attributes) {
                    piece.attributes.push_back(make_attributes(table.attributes(slot), fixed));
                }
                if (table.extras().weights) {
                    piece.weights.push_back(make_weight(table.weights(slot)));
                }
            }
            context.check_stop();
            return piece;
        },
        [&](std::uint64_t, const Piece& piece) {
            blocks.cells.append(piece.cells);
            blocks.borders.append(piece.borders);
            if (table.extras().attributes) blocks.attributes.append(piece.attributes);
            if (table.extras().weights) blocks.weights.append(piece.weights);
        });
    return blocks;
}

CellBlocks make_cell_blocks(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                            CellExtras extras) {
    CellBlocks blocks;
    blocks.lattice = lattice;
    blocks.grid = grid;
    blocks.codes = {context, "cell codes"};
    blocks.cells = {context, "cells"};
    if (extras.attributes) blocks.attributes = {context, "cell attributes"};
    if (extras.weights) blocks.weights = {context, "cell weights"};
    blocks.faces = {context, "surviving triangles"};
    blocks.borders = {context, "border lines"};
    return blocks;
}

}  // namespace hewer::cluster
