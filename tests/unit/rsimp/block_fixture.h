// SPDX-License-Identifier: MIT
/// Cell blocks of test meshes, and what is in cluster meshes, for comparisons.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/context.h"
#include "rsimp/cluster_mesh.h"
#include "tests/support/clustered_mesh.h"
#include "tests/support/shapes.h"

namespace hewer::rsimp {

/// Memory limits: all blocks in flight that there are threads for, or not.
inline constexpr std::uint64_t kAmple = std::uint64_t{4} << 30;
inline constexpr std::uint64_t kSmall = std::uint64_t{64} << 20;

/// The blocks of a mesh and the context that they live in.
struct BlockFixture {
    BlockFixture(const Mesh& mesh, double resolution, std::uint64_t most_cells,
                 unsigned n_threads = 2, std::uint64_t memory_bytes = kAmple)
        : context(std::make_unique<ooc::Context>(
              ooc::ResourceLimits{.memory_bytes = memory_bytes, .n_threads = n_threads})),
          blocks(test::cluster_mesh(*context, mesh, resolution, 1, most_cells)) {
        sort_faces();
    }

    [[nodiscard]] std::uint64_t n_cells_of(std::size_t b) const {
        return blocks.blocks[b + 1].first_cell - blocks.blocks[b].first_cell;
    }
    /// Inside each block; their order there is unspecified otherwise.
    void sort_faces();
    /// Made-up attributes, different for each cell.
    void add_attributes();

    std::unique_ptr<ooc::Context> context;
    cluster::CellBlocks blocks;
};

template <typename T>
std::vector<T> contents(const ooc::Spool<T>& spool) {
    std::vector<T> all(spool.size());
    spool.read(0, all);
    return all;
}

/// All of a mesh as bytes: outlives its context, whose threads would limit those of the next.
std::vector<char> snapshot(const ClusterMesh& mesh);

/// Faces of a block of the mesh, sorted.
std::vector<CellTriple> sorted_faces(const ClusterMesh& mesh, std::size_t block);

}  // namespace hewer::rsimp
