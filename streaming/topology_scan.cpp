// SPDX-License-Identifier: MIT
#include "streaming/topology_scan.h"

#include <span>

#include "streaming/equal_corners.h"
#include "streaming/topology_counter.h"
#include "streaming/weld.h"

namespace hewer::streaming {

namespace {

TopologyReport count_soup(ooc::Context& context, MeshSource& source) {
    Weld mesh(context, source);
    TopologyCounter counter(context, mesh.n_vertices(), ample_sort_bytes(context));
    mesh.for_triangles([&](std::span<const Triangle> piece) { counter.add(piece); });
    return counter.finish();
}

}  // namespace

TopologyReport count_topology(ooc::Context& context, MeshSource& source) {
    if (!source.info().is_indexed) return count_soup(context, source);
    TopologyCounter counter(context, source.info().n_vertices, ample_sort_bytes(context));
    for_triangle_batches(context, source,
                         [&](const TriangleBatch& batch) { counter.add(batch.corners); });
    return counter.finish();
}

}  // namespace hewer::streaming
