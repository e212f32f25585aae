// SPDX-License-Identifier: MIT
#include "clustered_mesh.h"

#include "cluster/vertex_store.h"
#include "mesh_checks.h"

namespace hewer::test {

ClusteredMesh::ClusteredMesh(ooc::Context& context, MeshSource& source, double resolution,
                             const Bounds& bounds)
    : lattice(bounds), grid(resolution), table(context, 16, false) {
    cluster::VertexStore vertices;
    if (source.info().is_indexed) {
        vertices = cluster::load_vertices(context, source, bounds, lattice);
        cluster::assign_cells(context, vertices, grid, table);
    }
    result =
        cluster::accumulate(context, {source, lattice, grid, vertices, bounds}, table, false);
}

std::map<cluster::CellKey, std::array<std::int64_t, 19>> ClusteredMesh::sums() {
    std::map<cluster::CellKey, std::array<std::int64_t, 19>> all;
    table.for_each([&](cluster::CellKey key, std::uint32_t slot) {
        auto& values = all[key];
        const cluster::CellSums& sums = table.sums(slot);
        for (std::size_t i = 0; i < 13; ++i) values[i] = sums.surface[i];
        for (std::size_t i = 0; i < 6; ++i) values[13 + i] = sums.border[i];
    });
    return all;
}

cluster::CellStore cluster_mesh(ooc::Context& context, const Mesh& mesh, double resolution,
                                double border_weight) {
    const auto source = view_mesh(mesh);
    ClusteredMesh clustered(context, *source, resolution, bounds_of(mesh));
    return cluster::build_cell_store(context, clustered.lattice, clustered.grid, clustered.table,
                                     clustered.result.triples, border_weight);
}

}  // namespace hewer::test
