// SPDX-License-Identifier: MIT
/// A streamed surface, read into memory on a lattice.
#pragma once

#include <cstdint>

#include "hewer/mesh_source.h"
#include "hewer/types.h"
#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// What must be known of a surface before it can be put on a lattice.
struct Census {
    std::uint64_t n_triangles = 0;  ///< an upper limit: those with non-finite corners are in it
    Bounds bounds;                  ///< of the finite points that triangles use
    /// Indexed meshes: one bit for each vertex, set if a triangle uses it.
    ooc::Array<std::uint64_t> used;
};

/// One pass over the triangles; indexed meshes: then one over the vertices.
/// Unused vertices do not count for the bounds: a stray one must not coarsen the lattice.
/// Memory: a bit for each vertex. Throws: FormatError, IoError, OutOfMemoryBudget, Cancelled.
Census take_census(ooc::Context& context, MeshSource& source);

struct ResidentSurface {
    ooc::Array<LatticeTriangle> triangles;  ///< the first n_triangles are in use, in no fixed order
    std::uint64_t n_triangles = 0;
    /// The first n_points are in use: every vertex that belongs to a triangle, in Morton order. A
    /// soup has no vertices; equal corners are taken for one.
    ooc::Array<LatticePoint> points;
    std::uint64_t n_points = 0;

    /// Bytes of the arrays for what a census has found.
    static std::uint64_t bytes(const MeshSource& source, const Census& census);
};

/// Reads what take_census() has counted: indexed meshes by one pass over the vertices and one over
/// the triangles, soups by one over the triangles. Triangles with a non-finite corner are left out;
/// degenerate ones are kept, as the segments and points that they are.
/// The set of triangles and the points do not depend on the number of threads.
/// Memory: 36 bytes a triangle, 12 bytes a vertex (a soup: 36 bytes a triangle).
/// Throws: FormatError (also when the counts are not those of the census), IoError,
/// OutOfMemoryBudget, Cancelled.
ResidentSurface load_surface(ooc::Context& context, MeshSource& source, Census census,
                             const Lattice& lattice);

}  // namespace hewer::measuring
