// SPDX-License-Identifier: MIT
/// The vertices of an indexed input in memory: lattice positions and the cell that each is in.
#pragma once

#include <cstdint>

#include "cluster/cell_table.h"
#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::cluster {

class VertexPages;

/// The box of all finite vertices (corners, for a soup): one pass over the vertices (triangles).
/// Defects met on the way are merged into `defects`. Throws FormatError if there is no finite
/// vertex.
Bounds scan_bounds(ooc::Context& context, MeshSource& source, InputDefects& defects);

/// Memory: 16 bytes a vertex.
struct VertexStore {
    /// Cells are for VertexPages; CellTable::kNone for a vertex with a non-finite coordinate.
    ooc::Array<PlacedPoint> vertices;

    [[nodiscard]] bool is_finite(std::uint64_t vertex) const {
        return vertices[vertex].cell != CellTable::kNone;
    }
};

/// Bounds and vertices of an input with single-precision positions in one pass: the floats wait in
/// the store, 12 bytes each, until the box and with it the lattice is known. Defects and an input
/// without a finite vertex as in scan_bounds(). Precondition: the source is indexed and has float
/// positions.
VertexStore load_float_vertices(ooc::Context& context, MeshSource& source, InputDefects& defects,
                                Bounds& bounds);

/// One pass over the vertices. Throws FormatError if one lies outside `bounds` (they were given by
/// the user, then).
VertexStore load_vertices(ooc::Context& context, MeshSource& source, const Bounds& bounds,
                          const Lattice& lattice);

/// The same points on a spool, for a source that cannot seek: VertexPages::kNotFinite for those
/// that have none. One pass over the vertices.
ooc::Spool<LatticePoint> spool_vertices(ooc::Context& context, MeshSource& source,
                                        const Bounds& bounds, const Lattice& lattice);

/// Adds normals, colours and weights of the vertices to their cells: one more pass over the
/// vertices. After the triangles, `pages` know the cells of most vertices that are in memory; null
/// if there are no pages. Of the others the cells are looked up. Returns how many weights were bad
/// (InputDefects::bad_weights).
std::uint64_t add_vertex_attributes(ooc::Context& context, MeshSource& source,
                                    const Lattice& lattice, const UniformGrid& grid,
                                    CellTable& table, const VertexPages* pages);

/// Throws FormatError naming the source and the box.
[[noreturn]] void throw_outside_bounds(const MeshSource& source, const std::string& what);

}  // namespace hewer::cluster
