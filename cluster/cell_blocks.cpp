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

/// The cells that a triangle has a corner in, in Morton order.
ooc::Array<CodedSlot> order_of_cells(ooc::Context& context, CellTable& table,
                                     std::uint64_t n_cells) {
    ooc::Array<CodedSlot> order(context.budget(), "cell order", n_cells);
    std::atomic<std::uint64_t> n{0};
    const bool is_any_unused = n_cells != table.size();
    context.workers().for_ranges(
        table.index_size(), kPiece, [&](std::uint64_t begin, std::uint64_t end) {
            std::vector<CodedSlot> found;
            found.reserve(end - begin);
            table.for_each_in(begin, end, [&](CellKey key, std::uint32_t slot) {
                // Most often no vertex is unused: no need to look.
                if (is_any_unused && table.sums(slot).is_touched == 0) return;
                found.push_back({morton(key), slot, 0});
            });
            std::copy(found.begin(), found.end(), order.begin() + n.fetch_add(found.size()));
        });
    ooc::Array<CodedSlot> scratch(context.budget(), "cell order", n_cells);
    ooc::radix_sort(context.workers(), order, scratch, [](const CodedSlot& s) { return s.code; });
    return order;
}

/// The triples by ids, sorted into the blocks of their median corners.
void append_faces(ooc::Context& context, const ooc::Array<std::uint32_t>& rank,
                  std::vector<TripleList>& triples, CellBlocks& blocks) {
    std::vector<std::pair<ooc::Array<CellTriple>, std::uint64_t>> pieces;
    for (TripleList& list : triples) {
        for (;;) {
            pieces.push_back(list.pop_piece());
            if (pieces.back().second == 0) break;
        }
        pieces.pop_back();
    }
    // Cells are cut into blocks, so that the block of a cell is found in a small table.
    const std::size_t n_blocks = blocks.n_blocks();
    ooc::Array<std::uint32_t> block_of(context.budget(), "blocks of cells", blocks.n_cells());
    for (std::uint32_t b = 0; b < n_blocks; ++b) {
        std::fill(block_of.begin() + blocks.blocks[b].first_cell,
                  block_of.begin() + blocks.blocks[b + 1].first_cell, b);
    }
    // A few groups of pieces for each thread, with the number of triples that each has in each
    // block, and then where these go.
    const std::uint64_t n_groups =
        std::min<std::uint64_t>(pieces.size(), 4 * std::uint64_t{context.n_threads()});
    std::vector<std::vector<std::uint64_t>> starts(n_groups, std::vector<std::uint64_t>(n_blocks));
    const auto for_each_piece = [&](const auto& body) {
        context.workers().for_ranges(n_groups, 1, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t g = begin; g < end; ++g) {
                const std::uint64_t last = (g + 1) * pieces.size() / n_groups;
                for (std::uint64_t i = g * pieces.size() / n_groups; i < last; ++i) {
                    auto& [piece, used] = pieces[i];
                    body(piece, used, starts[g]);
                }
            }
        });
    };
    using Piece = ooc::Array<CellTriple>;
    for_each_piece([&](Piece& piece, std::uint64_t used, std::vector<std::uint64_t>& counts) {
        for (std::uint64_t i = 0; i < used; ++i) {
            for (std::uint32_t& corner : piece[i]) corner = rank[corner];
            ++counts[block_of[median_corner(piece[i])]];
        }
    });
    std::uint64_t n = 0;
    for (std::size_t b = 0; b < n_blocks; ++b) {
        blocks.blocks[b].first_face = n;
        for (auto& start : starts) n += std::exchange(start[b], n);
    }
    blocks.blocks[n_blocks].first_face = n;
    ooc::Array<CellTriple> sorted(context.budget(), "triangles by block", n);
    for_each_piece([&](Piece& piece, std::uint64_t used, std::vector<std::uint64_t>& start) {
        for (std::uint64_t i = 0; i < used; ++i) {
            sorted[start[block_of[median_corner(piece[i])]]++] = piece[i];
        }
        piece.release();
    });
    pieces.clear();
    blocks.faces.append(sorted.span());
}

}  // namespace

CellBlocks build_cell_blocks(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                             CellTable& table, std::vector<TripleList>& triples,
                             double border_weight, std::uint64_t most_cells) {
    CellBlocks blocks = make_cell_blocks(context, lattice, grid, table.extras());
    const FixedPoint fixed(grid.resolution());
    const CellCounts counts = count_cells(context, table);
    const std::uint64_t n_cells = counts.touched;
    blocks.n_border_cells = counts.border;
    blocks.is_consistently_wound = !is_border_implausible(blocks.n_border_cells, n_cells);
    if (!blocks.is_consistently_wound) border_weight = 0;

    ooc::Array<CodedSlot> order = order_of_cells(context, table, n_cells);
    table.release_index();
    {
        BlockCutter cutter(blocks, most_cells);
        ooc::Array<std::uint32_t> rank(context.budget(), "cell ranks", table.size());
        context.workers().for_ranges(n_cells, kPiece, [&](std::uint64_t b, std::uint64_t e) {
            for (std::uint64_t k = b; k < e; ++k) {
                rank[order[k].slot] = static_cast<std::uint32_t>(k);
            }
        });
        std::vector<std::uint64_t> codes;
        for (std::uint64_t k = 0; k < n_cells; k += kPiece) {
            codes.clear();
            for (std::uint64_t i = k; i < std::min(n_cells, k + kPiece); ++i) {
                codes.push_back(order[i].code);
            }
            cutter.add(codes);
        }
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
