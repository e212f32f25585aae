// SPDX-License-Identifier: MIT
/// The clustered model: occupied cells in Morton order with their quadrics, and the surviving
/// triangles as triples of cells. What the input was (order, format, number of triangles) no longer
/// shows.
#pragma once

#include <array>
#include <cstdint>

#include "cluster/accumulate.h"
#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/quadric.h"
#include "cluster/uniform_grid.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::cluster {

/// One occupied cell; one cache line. Lengths in cells, areas in cell areas.
struct CellRecord {
    /// xx xy xz yy yz zz of A; b; c: the surface's planes and the weighted borders, relative to
    /// `mean`.
    std::array<float, 10> quadric;
    /// Area-weighted mean of the triangle corners in the cell, at most kMostOffset from the cell's
    /// centre on each axis; relative to that centre, or to the frame of the refiner's block.
    std::array<float, 3> mean;
    float area;        ///< of the surface that the cell stands for
    std::uint32_t id;  ///< own place in Morton order: stays with the record when it is moved
    std::uint32_t flags;

    static constexpr std::uint32_t kHasBorder = 1;
    static constexpr std::uint32_t kHasFace = 2;  ///< a surviving triangle has a corner here
    /// Below one half, so that rounding finds the centre again in single precision.
    static constexpr double kMostOffset = 0.45;
};
static_assert(sizeof(CellRecord) == 64);

/// Attributes of a cell, from the original vertices in it.
struct CellAttributes {
    std::array<float, 3> normal;       ///< sum of the vertex normals, not unit
    std::array<float, 3> face_normal;  ///< area-weighted sum of face normals, cell areas
    std::array<float, 4> color;        ///< sum over n_colors vertices, 0..65535 each
    float n_colors;

    CellAttributes& operator+=(const CellAttributes& other) {
        for (std::size_t i = 0; i < 3; ++i) normal[i] += other.normal[i];
        for (std::size_t i = 0; i < 3; ++i) face_normal[i] += other.face_normal[i];
        for (std::size_t i = 0; i < 4; ++i) color[i] += other.color[i];
        n_colors += other.n_colors;
        return *this;
    }
};

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
