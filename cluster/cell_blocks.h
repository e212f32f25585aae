// SPDX-License-Identifier: MIT
/// The clustered model in blocks: octree boxes of cells, in Morton order, with their triangles.
/// What the input was (order, format, number of triangles, memory it was clustered in) no longer
/// shows.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "cluster/accumulate.h"
#include "cluster/attribute_quadric.h"
#include "cluster/cell_record.h"
#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "ooc/spool.h"
#include "ooc/vec3.h"

namespace hewer::cluster {

/// A box of the octree over the grid: the cells whose Morton code agrees with `code` above the
/// lowest `shift` bits.
struct OctreeBox {
    std::uint64_t code = 0;  ///< lowest code in the box
    unsigned shift = 0;      ///< multiple of 3
};

/// Everything is in the order of the blocks, which is Morton order; ids are places in that order.
struct CellBlocks {
    /// A block has as many cells as a core's cache has room for, and is the unit that is loaded,
    /// refined and handed to threads. Blocks are the largest octree boxes that hold at most this.
    static constexpr std::uint64_t kMostCells = 1 << 15;

    struct Block {
        OctreeBox box;
        std::uint64_t first_cell = 0;
        std::uint64_t first_face = 0;
    };

    Lattice lattice;
    UniformGrid grid;
    ooc::Spool<std::uint64_t> codes;        ///< Morton codes of the occupied cells, rising
    ooc::Spool<CellRecord> cells;           ///< means relative to the cell's centre
    ooc::Spool<CellAttributes> attributes;  ///< empty if the input has none
    ooc::Spool<float> weights;              ///< means over the vertices; empty if they have none
    /// What colours and normals count in the error metric; empty unless that is asked for.
    ooc::Spool<CellAttributeQuadric> attribute_quadrics;
    /// Cell ids, three different ones, wound as the triangle was. A face is in the block of its
    /// median corner (by id): so the faces with at least two corners in a block are all in its
    /// list. Duplicates and opposite pairs are still there; the order inside a block is
    /// unspecified.
    ooc::Spool<CellTriple> faces;
    /// Square of the distance, in cells, from a level of detail made before in which nothing near
    /// the cell was left; 0 where it was. Empty if nothing had vanished.
    ooc::Spool<float> vanished;
    ooc::Spool<BorderLine> borders;  ///< of the cells with a border, by rising cell
    std::vector<Block> blocks;       ///< and one more at the end, with the totals
    std::uint64_t n_border_cells = 0;
    bool is_consistently_wound = true;
    /// Nearly every position of the input has a cell of its own, so that faces are those of the
    /// input.
    bool has_vertex_cells = false;

    [[nodiscard]] std::uint64_t n_cells() const { return codes.size(); }
    [[nodiscard]] std::size_t n_blocks() const { return blocks.empty() ? 0 : blocks.size() - 1; }
    /// From cells to model units.
    [[nodiscard]] Vec3 to_model(const Vec3& in_cells) const {
        return lattice.origin() + (grid.cell_size(lattice) * in_cells);
    }
};

/// Of three different ids (or codes, which are in the same order) the one in the middle.
template <typename Id>
Id median_corner(const std::array<Id, 3>& t) {
    return std::max(std::min(t[0], t[1]), std::min(std::max(t[0], t[1]), t[2]));
}

CellBlocks make_cell_blocks(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                            CellExtras extras);

/// Turns sums into records, sorts them, renumbers the triples. Consumes `table` and `triples`.
/// Memory: beside the blocks 36 bytes a cell and 24 a triangle.
CellBlocks build_cell_blocks(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                             CellTable& table, std::vector<TripleList>& triples,
                             double border_weight,
                             std::uint64_t most_cells = CellBlocks::kMostCells);

/// Centre of a cell, in cells from the lattice origin.
inline Vec3 center_of(std::uint64_t code) {
    const auto c = unpack_morton(code);
    return {c[0] + 0.5, c[1] + 0.5, c[2] + 0.5};
}

}  // namespace hewer::cluster
