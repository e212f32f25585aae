// SPDX-License-Identifier: MIT
/// Cells that exceed memory: sorted runs of partial sums, and their merge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cluster/accumulate.h"
#include "cluster/cell_blocks.h"
#include "cluster/cell_sums.h"
#include "cluster/cell_table.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::cluster {

/// The sums of one cell in one run. Sums of several runs add without rounding, so it does not
/// matter how often and when the table was full.
struct RunCell {
    std::uint64_t code;
    std::array<std::int64_t, 13> surface;
    std::array<std::uint32_t, 6> border;
    std::uint32_t is_touched;
    std::uint32_t unused;
};
static_assert(sizeof(RunCell) == 144);

/// Morton codes of three different cells, wound as the triangle was.
using CodeTriple = std::array<std::uint64_t, 3>;

class CellRuns {
  public:
    CellRuns(ooc::Context& context, bool has_attributes)
        : context_(context), has_attributes_(has_attributes) {
        clear();
    }

    /// Everything in the table and all triples, as one more run: cells by code, triples by the code
    /// of their median corner. The triples are taken away, the table stays as it is. Memory beside
    /// them: bytes_per_cell().
    void add(CellTable& table, std::vector<TripleList>& triples);
    void clear();
    [[nodiscard]] bool empty() const { return n_runs() == 0; }
    [[nodiscard]] std::uint64_t n_runs() const { return ends_.size() - 1; }

    /// The cells of all runs, as build_cell_blocks() makes them of one table; leaves no runs. One
    /// pass over them, two if the winding turns out to be inconsistent. Memory: a read buffer for
    /// each run, all together a small part of the limit, and for each worker the codes of a few
    /// blocks.
    CellBlocks merge(const Lattice& lattice, const UniformGrid& grid, double border_weight,
                     std::uint64_t most_cells);

    /// Of the table with its triples, and what add() needs beside it, for each cell; with
    /// kTriplesPerCell, which a surface has.
    static constexpr double kTriplesPerCell = 2.5;
    static constexpr double bytes_per_cell(bool has_attributes) {
        return sizeof(CellSums) + (has_attributes ? sizeof(AttributeSums) : 0) + 34 /* index */ +
               32 /* order */ + 12 /* codes, ranks */ + kTriplesPerCell * 3 * sizeof(CellTriple);
    }

  private:
    struct RunEnd {
        std::uint64_t cell;
        std::uint64_t triple;
    };
    [[nodiscard]] std::uint64_t buffer_bytes() const;
    void merge_cells(double border_weight, std::uint64_t most_cells, CellBlocks& blocks) const;
    void merge_triples(CellBlocks& blocks);

    ooc::Context& context_;
    bool has_attributes_;
    // All runs behind one another: the unfinished page of a spool is memory that cannot be evicted.
    ooc::Spool<RunCell> cells_;
    ooc::Spool<AttributeSums> attributes_;  // parallel to cells; empty if the input has none
    ooc::Spool<CodeTriple> triples_;
    std::vector<RunEnd> ends_;  // and zeros before
};

}  // namespace hewer::cluster
