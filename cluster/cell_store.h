// SPDX-License-Identifier: MIT
/// The clustered model: occupied cells in Morton order with their quadrics, and the surviving
/// triangles as triples of cells. What the input was (order, format, number of triangles) no longer
/// shows.
#pragma once

#include <cstdint>

#include "cluster/accumulate.h"
#include "cluster/cell_record.h"
#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/quadric.h"
#include "cluster/uniform_grid.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

struct CellStore {
    Lattice lattice;
    UniformGrid grid;
    ooc::Array<std::uint64_t> codes;  ///< Morton codes, rising
    ooc::Array<CellRecord> cells;     ///< cells[i] is at codes[i] until a refiner permutes them
    ooc::Array<CellAttributes> attributes;  ///< by id; empty if the input has none
    ooc::Array<CellTriple> triangles;  ///< ids of three different cells; duplicates and opposite
                                       ///< pairs are still there; order unspecified
    std::uint64_t n_border_cells = 0;
    bool is_consistently_wound = true;

    /// Centre of cell `id` in cells from the lattice origin.
    [[nodiscard]] Vec3 center(std::uint64_t id) const {
        const auto c = unpack_morton(codes[id]);
        return {c[0] + 0.5, c[1] + 0.5, c[2] + 0.5};
    }
    /// From cells to model units.
    [[nodiscard]] Vec3 to_model(const Vec3& in_cells) const {
        return lattice.origin() + (grid.cell_size(lattice) * in_cells);
    }
};

/// Turns sums into records, sorts them, renumbers the triples. Consumes `table` and `triples`.
/// Memory: 76 bytes a cell and 12 a triangle for the result; 28 a cell more on the way.
CellStore build_cell_store(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                           CellTable& table, std::vector<TripleList>& triples,
                           double border_weight);

}  // namespace hewer::cluster
