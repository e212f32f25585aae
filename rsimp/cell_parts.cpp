// SPDX-License-Identifier: MIT
#include "rsimp/cell_parts.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "ooc/spool_cache.h"
#include "rsimp/blocks_in_flight.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellTriple;

/// A triangle that reaches from a piece to a cell of another block.
struct Link {
    std::uint32_t piece;
    std::uint32_t cell;
};

/// The pieces of one block.
struct BlockPieces {
    std::vector<std::uint32_t> piece;  // of each cell
    std::vector<Link> links;
    std::uint32_t n_pieces = 0;

    static std::uint64_t bytes_for(const LargestBlock& largest) {
        return largest.n_cells * 2 * sizeof(std::uint32_t) + largest.n_faces * 2 * sizeof(Link) +
               ooc::SpoolReader<CellTriple>::kBufferBytes;
    }

    void find(const CellBlocks& cells, std::size_t b) {
        const auto& first = cells.blocks[b];
        const auto& last = cells.blocks[b + 1];
        const std::uint64_t n = last.first_cell - first.first_cell;
        piece.resize(n);
        std::iota(piece.begin(), piece.end(), 0U);
        links.clear();
        ooc::SpoolReader<CellTriple> reader(cells.faces, first.first_face, last.first_face);
        for (auto faces = reader.next_piece(); !faces.empty(); faces = reader.next_piece()) {
            for (const CellTriple& face : faces) {
                const std::uint32_t middle = cluster::median_corner(face);
                const auto local = static_cast<std::uint32_t>(middle - first.first_cell);
                for (const std::uint32_t cell : face) {
                    if (cell == middle) continue;
                    if (cell - first.first_cell < n) {
                        join(local, static_cast<std::uint32_t>(cell - first.first_cell));
                    } else {
                        links.push_back({local, cell});
                    }
                }
            }
        }
        // A label is never larger than its place, so those before are final.
        n_pieces = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            piece[i] = piece[i] == i ? n_pieces++ : piece[piece[i]];
        }
        for (Link& link : links) link.piece = piece[link.piece];
        const auto key = [](const Link& l) { return std::uint64_t{l.cell} << 32 | l.piece; };
        std::sort(links.begin(), links.end(),
                  [&](const Link& x, const Link& y) { return key(x) < key(y); });
        links.erase(std::unique(links.begin(), links.end(),
                                [&](const Link& x, const Link& y) { return key(x) == key(y); }),
                    links.end());
    }

  private:
    std::uint32_t root(std::uint32_t i) {
        while (piece[i] != i) i = piece[i] = piece[piece[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a);
        b = root(b);
        piece[std::max(a, b)] = std::min(a, b);
    }
};

}  // namespace

CellParts::CellParts(ooc::Context& context, const CellBlocks& cells)
    : pieces_(context, "pieces of parts, by cell") {
    ooc::Spool<Link> links(context, "links between pieces");
    std::uint32_t n_pieces = 0;
    {
        const BlocksInFlight in_flight(context, "pieces of a block",
                                       BlockPieces::bytes_for(LargestBlock(cells)));
        in_flight.sweep<BlockPieces>(
            cells.n_blocks(), [&](std::uint64_t b, BlockPieces& block) { block.find(cells, b); },
            [&](std::uint64_t, BlockPieces& block) {
                for (std::uint32_t& p : block.piece) p += n_pieces;
                for (Link& link : block.links) link.piece += n_pieces;
                pieces_.append(block.piece);
                links.append(block.links);
                n_pieces += block.n_pieces;
            });
    }
    sets_ = {context.budget(), "parts of the model", n_pieces};
    ooc::SpoolCache<std::uint32_t> piece_of(pieces_);
    ooc::SpoolReader<Link> reader(links);
    while (const Link* link = reader.next()) sets_.join(link->piece, piece_of.at(link->cell));
}

}  // namespace hewer::rsimp
