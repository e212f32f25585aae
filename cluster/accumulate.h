// SPDX-License-Identifier: MIT
/// Lindstrom's out-of-core simplification (OoCS), first half: one pass over the triangles gathers
/// the quadrics of the cells and keeps the triangles whose corners are in three different cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cluster/cell_record.h"
#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "cluster/vertex_store.h"
#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

/// A list that grows by pieces and never moves. Memory: 12 bytes a triple.
class TripleList {
  public:
    void push(ooc::MemoryBudget& budget, const CellTriple& triple) {
        if (used_ == kPiece || pieces_.empty()) {
            pieces_.emplace_back(budget, "surviving triangles", kPiece);
            used_ = 0;
        }
        pieces_.back()[used_++] = triple;
    }
    [[nodiscard]] std::uint64_t size() const {
        return pieces_.empty() ? 0 : (pieces_.size() - 1) * kPiece + used_;
    }
    /// Takes the last piece out: (triples, how many of them count). Empty when nothing is left.
    std::pair<ooc::Array<CellTriple>, std::uint64_t> pop_piece();

  private:
    static constexpr std::uint64_t kPiece = 1 << 15;
    std::vector<ooc::Array<CellTriple>> pieces_;
    std::uint64_t used_ = 0;
};

struct AccumulateResult {
    std::vector<TripleList> triples;  ///< one per worker; order means nothing
    InputDefects defects;
    std::uint64_t n_triangles = 0;
    double area = 0;  ///< square model units
};

/// What a pass over the triangles of an indexed mesh or of a soup works on.
struct AccumulateInput {
    MeshSource& source;
    const Lattice& lattice;
    const UniformGrid& grid;
    const VertexStore& vertices;  ///< empty for a soup
    const Bounds& bounds;         ///< checked for soups
};

/// Per triangle: its plane, weighted by a third of its area, goes to the cell of each corner (a
/// triangle inside one cell brings its whole area), so that the quadrics of all cells add up to the
/// surface's. Degenerate triangles bring no plane but take part in borders and connectivity, so
/// that a closed surface stays closed.
///
/// One pass, all workers. Unlike the paper: area instead of area-squared weights, border sums,
/// exact integer sums, and duplicates are left to the consumer of the triples. Throws: what the
/// source throws, OutOfMemoryBudget, Cancelled.
AccumulateResult accumulate(ooc::Context& context, const AccumulateInput& input, CellTable& table,
                            bool with_face_normals);

}  // namespace hewer::cluster
