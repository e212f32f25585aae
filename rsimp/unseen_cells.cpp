// SPDX-License-Identifier: MIT
#include <atomic>
#include <optional>
#include <vector>

#include "ooc/spool_cache.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/cell_parts.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

namespace {

using cluster::CellBlocks;
using cluster::CellTriple;

/// A bit for each piece whose part has a face between three clusters.
class SeenPieces {
  public:
    SeenPieces(ooc::Context& context, const CellBlocks& cells, const ClusterMesh& clusters,
               CellParts& parts)
        : pieces_(&parts.pieces()),
          bits_(context.budget(), "parts that clusters see", parts.n_pieces() / 64 + 1) {
        struct Work {
            std::vector<std::uint32_t> pieces;
            std::vector<std::uint32_t> clusters;
        };
        const BlocksInFlight in_flight(context, "clusters of a block's cells",
                                       LargestBlock(cells).n_cells * 2 * sizeof(std::uint32_t) +
                                           ooc::SpoolReader<CellTriple>::kBufferBytes +
                                           ooc::SpoolCache<std::uint32_t>::kBytes);
        in_flight.sweep<Work>(
            cells.n_blocks(),
            [&](std::uint64_t b, Work& work) {
                mark_block(cells, clusters.cluster_of_cell, b, work.pieces, work.clusters);
            },
            [](std::uint64_t, const Work&) {});
        // From pieces to their parts, and back to all pieces of these.
        for (std::uint64_t p = 0; p < parts.n_pieces(); ++p) {
            if (has(p)) mark(parts.part_of(p));
        }
        for (std::uint64_t p = 0; p < parts.n_pieces(); ++p) {
            if (has(parts.part_of(p))) mark(p);
        }
    }
    [[nodiscard]] bool has(std::uint64_t piece) const {
        return (bits_[piece / 64] >> (piece % 64) & 1) != 0;
    }
    void read(std::uint64_t first, std::vector<std::uint32_t>& pieces) const {
        pieces_->read(first, pieces);
    }

  private:
    void mark_block(const CellBlocks& cells, const ooc::Spool<std::uint32_t>& cluster_of_cell,
                    std::size_t b, std::vector<std::uint32_t>& pieces,
                    std::vector<std::uint32_t>& clusters) {
        const auto& first = cells.blocks[b];
        const auto& last = cells.blocks[b + 1];
        const std::uint64_t n = last.first_cell - first.first_cell;
        pieces.resize(n);
        pieces_->read(first.first_cell, pieces);
        clusters.resize(n);
        cluster_of_cell.read(first.first_cell, clusters);
        std::optional<ooc::SpoolCache<std::uint32_t>> outside;
        const auto cluster_of = [&](std::uint32_t cell) {
            if (cell - first.first_cell < n) return clusters[cell - first.first_cell];
            if (!outside) outside.emplace(cluster_of_cell);
            return outside->at(cell);
        };
        ooc::SpoolReader<CellTriple> reader(cells.faces, first.first_face, last.first_face);
        for (auto faces = reader.next_piece(); !faces.empty(); faces = reader.next_piece()) {
            for (const CellTriple& face : faces) {
                const std::uint64_t piece = pieces[cluster::median_corner(face) - first.first_cell];
                // Of a large part the first faces tell.
                const std::atomic_ref<std::uint64_t> word(bits_[piece / 64]);
                const std::uint64_t bit = std::uint64_t{1} << (piece % 64);
                if ((word.load(std::memory_order_relaxed) & bit) != 0) continue;
                const std::uint32_t a = cluster_of(face[0]);
                const std::uint32_t c1 = cluster_of(face[1]);
                const std::uint32_t c2 = cluster_of(face[2]);
                if (a == c1 || c1 == c2 || a == c2) continue;
                word.fetch_or(bit, std::memory_order_relaxed);
            }
        }
    }
    void mark(std::uint64_t piece) { bits_[piece / 64] |= std::uint64_t{1} << (piece % 64); }

    const ooc::Spool<std::uint32_t>* pieces_;
    ooc::Array<std::uint64_t> bits_;
};

}  // namespace

void find_unseen_cells(ooc::Context& context, const CellBlocks& cells, const ClusterMesh& clusters,
                       ooc::Spool<LostPart>& lost) {
    const FacedCells faced(context, cells);
    std::optional<CellParts> parts;
    std::optional<SeenPieces> seen;
    if (clusters.n_clusters() < cells.n_cells()) {
        parts.emplace(context, cells);
        seen.emplace(context, cells, clusters, *parts);
    }
    struct Work {
        std::optional<cluster::CodeLookup> lookup;
        std::vector<std::uint64_t> codes;
        std::vector<std::uint32_t> pieces;
        std::vector<LostPart> parts;
    };
    const BlocksInFlight in_flight(
        context, "codes of a block",
        LargestBlock(cells).n_cells *
            (sizeof(std::uint64_t) * (1 + cluster::CodeLookup::kBlocks) + sizeof(std::uint32_t)));
    in_flight.sweep<Work>(
        cells.n_blocks(),
        [&](std::uint64_t b, Work& work) {
            if (!work.lookup) work.lookup.emplace(cells);
            const std::uint64_t first = cells.blocks[b].first_cell;
            work.codes.resize(cells.blocks[b + 1].first_cell - first);
            cells.codes.read(first, work.codes);
            work.pieces.resize(seen ? work.codes.size() : 0);
            if (seen) seen->read(first, work.pieces);
            work.parts.clear();
            const auto has_face = [&](std::uint64_t code) {
                const auto id = work.lookup->find(code);
                return id && faced.has(*id);
            };
            for (std::uint64_t i = 0; i < work.codes.size(); ++i) {
                const bool is_unseen = faced.has(first + i)
                                           ? seen && !seen->has(work.pieces[i])
                                           : !any_neighbour(work.codes[i], has_face);
                if (!is_unseen) continue;
                const Vec3 center = cluster::center_of(work.codes[i]) - clusters.origin;
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
