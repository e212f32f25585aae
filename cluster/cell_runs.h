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

/// As many runs as one merge takes become one of the next higher level at once: read buffers do
/// not grow with the input.
class CellRuns {
  public:
    CellRuns(ooc::Context& context, CellExtras extras);

    /// Everything in the table and all triples, as one more run: cells by code, triples by the code
    /// of their median corner. The triples are taken away, the table stays as it is. Memory beside
    /// them: bytes_per_cell(), and read buffers of a small part of the limit.
    void add(CellTable& table, std::vector<TripleList>& triples);
    void clear() { levels_.clear(); }
    [[nodiscard]] bool empty() const { return levels_.empty(); }
    [[nodiscard]] std::uint64_t n_runs() const;

    /// The cells of all runs, as build_cell_blocks() makes them of one table; leaves no runs. One
    /// pass over them, two if the winding turns out to be inconsistent. Memory: a read buffer for
    /// each run, all together a small part of the limit, and for each worker the codes of a few
    /// blocks.
    CellBlocks merge(const Lattice& lattice, const UniformGrid& grid, double border_weight,
                     std::uint64_t most_cells);

    /// Of the table with its triples, and what add() needs beside it, for each cell; with
    /// kTriplesPerCell, which a surface has.
    static constexpr double kTriplesPerCell = 2.5;
    static double bytes_per_cell(CellExtras extras) {
        return static_cast<double>(sizeof(CellSums) + extras.bytes()) + 34 /* index */ +
               32 /* order */ + 12 /* codes, ranks */ + kTriplesPerCell * 3 * sizeof(CellTriple);
    }

  private:
    /// Runs behind one another: the unfinished page of a spool is memory that cannot be evicted.
    struct Level {
        ooc::Spool<RunCell> cells;
        ooc::Spool<AttributeSums> attributes;  // parallel to cells; empty if the input has none
        ooc::Spool<WeightSums> weights;        // the same
        ooc::Spool<CodeTriple> triples;
        struct End {
            std::uint64_t cell;
            std::uint64_t triple;
        };
        std::vector<End> ends;  // and zeros before
        [[nodiscard]] std::uint64_t n_runs() const { return ends.size() - 1; }
    };
    [[nodiscard]] Level new_level() const;
    void write_run(CellTable& table, std::vector<TripleList>& triples, Level& level) const;
    /// All runs as one more of `to`. Leaves none.
    void merge_into(Level& to, std::vector<Level> from) const;
    /// visit(code, sums, attributes, weights) for each cell of all runs, by code.
    template <typename Visit>
    void for_each_cell(const std::vector<Level>& levels, const Visit& visit) const;
    [[nodiscard]] std::uint64_t buffer_bytes(std::uint64_t n_runs) const;
    [[nodiscard]] ooc::Reservation triple_readers(
        const std::vector<Level>& levels, std::vector<ooc::SpoolReader<CodeTriple>>& readers) const;
    void merge_cells(const std::vector<Level>& levels, double border_weight,
                     std::uint64_t most_cells, CellBlocks& blocks) const;
    void merge_triples(const std::vector<Level>& levels, CellBlocks& blocks) const;

    ooc::Context& context_;
    CellExtras extras_;
    std::uint64_t fan_in_;
    std::vector<Level> levels_;
};

}  // namespace hewer::cluster
