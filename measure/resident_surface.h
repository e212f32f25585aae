// SPDX-License-Identifier: MIT
/// A streamed surface, read into memory on a lattice.
#pragma once

#include <cstdint>

#include "hewer/mesh_source.h"
#include "measure/census.h"
#include "measure/lattice.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/parallel.h"

namespace hewer::measuring {

struct ResidentSurface {
    ooc::Array<LatticeTriangle> triangles;  ///< in no fixed order
    /// The first n_points are in use: every vertex that counts, in Morton order. A soup has no
    /// vertices; equal corners are taken for one.
    ooc::Array<LatticePoint> points;
    std::uint64_t n_points = 0;

    /// At most.
    static std::uint64_t max_points(const MeshSource& source, const Census& census);
    /// Bytes of the arrays for what a census has found.
    static std::uint64_t bytes(const MeshSource& source, const Census& census);
};

/// Reads what take_census() has counted: indexed meshes by one pass over the vertices and one over
/// the triangles, soups by one over the triangles. Degenerate triangles are kept, as the segments
/// and points that they are. The set of triangles and the points do not depend on the number of
/// threads.
/// Memory: 36 bytes a triangle, 12 bytes a vertex (a soup: 36 bytes a triangle).
/// Throws: FormatError (also when the counts are not those of the census), IoError,
/// OutOfMemoryBudget, Cancelled.
ResidentSurface load_surface(ooc::Context& context, MeshSource& source, const Census& census,
                             const Lattice& lattice);

/// The file is not what it was when its triangles were counted.
[[noreturn]] void throw_changed(const MeshSource& source);

/// body(batch) for every batch of vertices, on all threads.
template <typename Body>
void for_vertex_batches(ooc::Context& context, MeshSource& source, const Body& body) {
    source.begin_vertices();
    context.workers().on_each([&](unsigned worker) {
        VertexBatch batch;
        while (source.next_vertices(batch)) {
            if (batch.first + batch.positions.size() > source.info().n_vertices) {
                throw_changed(source);
            }
            body(worker, batch);
            context.advance(batch.positions.size());
        }
    });
}

}  // namespace hewer::measuring
