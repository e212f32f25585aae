// SPDX-License-Identifier: MIT
/// Lindstrom's out-of-core simplification (OoCS), first half: one pass over the triangles gathers
/// the quadrics of the cells and keeps the triangles whose corners are in three different cells.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "cluster/cell_record.h"
#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/triangle_partition.h"
#include "cluster/uniform_grid.h"
#include "cluster/vertex_pages.h"
#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

/// A list that grows by pieces and never moves. Memory: 12 bytes a triple.
class TripleList {
  public:
    /// `n_pieces`, if given, counts the pieces of several lists.
    explicit TripleList(std::atomic<std::uint64_t>* n_pieces = nullptr) : counter_(n_pieces) {}
    void push(ooc::MemoryBudget& budget, const CellTriple& triple) {
        if (used_ == kPiece || pieces_.empty()) {
            pieces_.emplace_back(budget, "surviving triangles", kPiece);
            used_ = 0;
            if (counter_ != nullptr) counter_->fetch_add(1, std::memory_order_relaxed);
        }
        pieces_.back()[used_++] = triple;
    }
    [[nodiscard]] std::uint64_t size() const {
        return pieces_.empty() ? 0 : (pieces_.size() - 1) * kPiece + used_;
    }
    static constexpr std::uint64_t kPiece = 1 << 13;
    /// Takes the last piece out: (triples, how many of them count). Empty when nothing is left.
    std::pair<ooc::Array<CellTriple>, std::uint64_t> pop_piece();

  private:
    std::vector<ooc::Array<CellTriple>> pieces_;
    std::uint64_t used_ = 0;
    std::atomic<std::uint64_t>* counter_;
};

struct AccumulateResult {
    InputDefects defects;
    std::uint64_t n_triangles = 0;
    double area = 0;  ///< square model units
};

/// What a pass over the triangles of an indexed mesh or of a soup works on.
struct AccumulateInput {
    MeshSource& source;
    const Lattice& lattice;
    const UniformGrid& grid;
    VertexPages* vertices;  ///< null for a soup
    const Bounds& bounds;   ///< checked for soups
    /// Most spills of the table before the triangles count as incoherent. None: they never do.
    std::optional<std::uint64_t> most_spills = std::nullopt;
};

/// Per triangle: its plane, weighted by a third of its area, goes to the cell of each corner (a
/// triangle inside one cell brings its whole area), so that the quadrics of all cells add up to the
/// surface's. Degenerate triangles bring no plane but take part in borders and connectivity, so
/// that a closed surface stays closed.
///
/// One pass, all workers. Unlike the paper: area instead of area-squared weights, border sums,
/// exact integer sums, and duplicates are left to the consumer of the triples. Throws: what the
/// source throws, OutOfMemoryBudget, Cancelled, Incoherent.
/// `triples` has a list for each worker; they may be taken away when the table spills.
AccumulateResult accumulate(ooc::Context& context, const AccumulateInput& input, CellTable& table,
                            std::vector<TripleList>& triples, bool with_face_normals);

/// Thrown by accumulate() where it would take for ever: the triangles jump about in the file (see
/// VertexPages) or in space, so that the window or the table is refilled for every few of them.
struct Incoherent {};

/// The same for triangles that have been brought into order. No defects are met any more.
AccumulateResult accumulate(ooc::Context& context, TrianglePartition& partition,
                            const Lattice& lattice, const UniformGrid& grid, CellTable& table,
                            std::vector<TripleList>& triples, bool with_face_normals);

}  // namespace hewer::cluster
