// SPDX-License-Identifier: MIT
/// The first half of the pipeline on a grid of the test's choice.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "cluster/accumulate.h"
#include "cluster/cell_blocks.h"
#include "cluster/cell_table.h"
#include "hewer/mesh_source.h"
#include "ooc/context.h"

namespace hewer::test {

/// Enough of everything for tests.
inline std::unique_ptr<ooc::Context> make_context(unsigned n_threads = 2) {
    return std::make_unique<ooc::Context>(
        ooc::ResourceLimits{.memory_bytes = std::uint64_t{4} << 30, .n_threads = n_threads});
}

/// A mesh after the pass over its triangles.
struct ClusteredMesh {
    ClusteredMesh(ooc::Context& context, MeshSource& source, double resolution,
                  const Bounds& bounds);

    cluster::Lattice lattice;
    cluster::UniformGrid grid;
    cluster::CellTable table;
    std::vector<cluster::TripleList> triples;
    cluster::AccumulateResult result;

    /// Integer sums by cell: 13 of the surface, then 6 of the border.
    [[nodiscard]] std::map<cluster::CellKey, std::array<std::int64_t, 19>> sums();
};

/// The cells of an indexed mesh.
cluster::CellBlocks cluster_mesh(ooc::Context& context, const Mesh& mesh, double resolution,
                                 double border_weight = 1,
                                 std::uint64_t most_cells = cluster::CellBlocks::kMostCells);

template <typename T>
std::vector<T> read_all(const ooc::Spool<T>& spool) {
    std::vector<T> records(spool.size());
    spool.read(0, records);
    return records;
}

/// The same in memory; ids are set.
struct Cells {
    explicit Cells(const cluster::CellBlocks& blocks);

    cluster::Lattice lattice;
    cluster::UniformGrid grid;
    std::vector<std::uint64_t> codes;
    std::vector<cluster::CellRecord> cells;
    std::vector<cluster::CellAttributes> attributes;
    std::vector<cluster::CellTriple> faces;
    std::vector<cluster::CellBlocks::Block> blocks;
    std::uint64_t n_border_cells;
    bool is_consistently_wound;

    [[nodiscard]] Vec3 center(std::uint64_t id) const { return cluster::center_of(codes[id]); }
};

}  // namespace hewer::test
