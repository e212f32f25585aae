// SPDX-License-Identifier: MIT
#include "clustered_mesh.h"

#include "cluster/vertex_store.h"
#include "mesh_checks.h"

namespace hewer::test {

ClusteredMesh::ClusteredMesh(ooc::Context& context, MeshSource& source, double resolution,
                             const Bounds& bounds)
    : lattice(bounds), grid(resolution), table(context, 16, false) {
    cluster::VertexStore vertices;
    std::optional<cluster::VertexPages> pages;
    if (source.info().is_indexed) {
        vertices = cluster::load_vertices(context, source, bounds, lattice);
        pages.emplace(table, vertices);
    }
    triples.resize(context.n_threads());
    result = cluster::accumulate(
        context, {source, lattice, grid, pages ? &*pages : nullptr, bounds}, table, triples, false);
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

cluster::CellBlocks cluster_mesh(ooc::Context& context, const Mesh& mesh, double resolution,
                                 double border_weight, std::uint64_t most_cells) {
    const auto source = view_mesh(mesh);
    ClusteredMesh clustered(context, *source, resolution, bounds_of(mesh));
    return cluster::build_cell_blocks(context, clustered.lattice, clustered.grid, clustered.table,
                                      clustered.triples, border_weight, most_cells);
}

Cells::Cells(const cluster::CellBlocks& source)
    : lattice(source.lattice),
      grid(source.grid),
      codes(read_all(source.codes)),
      cells(read_all(source.cells)),
      attributes(read_all(source.attributes)),
      faces(read_all(source.faces)),
      blocks(source.blocks),
      n_border_cells(source.n_border_cells),
      is_consistently_wound(source.is_consistently_wound) {
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].id = static_cast<std::uint32_t>(i);
}

}  // namespace hewer::test
