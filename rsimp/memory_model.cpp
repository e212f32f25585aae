// SPDX-License-Identifier: MIT
#include "rsimp/memory_model.h"

#include <algorithm>
#include <bit>

#include "cluster/cell_record.h"
#include "cluster/cell_sums.h"
#include "ooc/memory_budget.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/cluster_tree.h"

namespace hewer::rsimp {

std::uint64_t peak_memory_bytes(const MemoryCounts& n) {
    using cluster::AttributeSums;
    using cluster::CellAttributes;
    using cluster::CellRecord;
    using cluster::CellSums;
    const std::uint64_t attribute_sums = n.has_attributes ? sizeof(AttributeSums) : 0;
    const std::uint64_t attributes = n.has_attributes ? sizeof(CellAttributes) : 0;
    // Table of 12 bytes a slot, 70 % full at most, a power of two.
    const std::uint64_t table = 12 * std::bit_ceil(n.cells * 3 / 2 + 1);
    const std::uint64_t sums = n.cells * (sizeof(CellSums) + attribute_sums);
    const std::uint64_t triples = n.surviving_triangles * sizeof(cluster::CellTriple);

    const std::uint64_t accumulate = 16 * n.vertices + table + sums + triples;
    // Sorted order, codes and ranks of the cells, and their records, beside the sums.
    const std::uint64_t store =
        sums + n.cells * (16 + 8 + 4 + sizeof(CellRecord) + attributes) + triples;
    const std::uint64_t kept = n.cells * (8 + sizeof(CellRecord) + attributes) + triples;
    // Two nodes for each leaf, in vectors that double; a vertex, quadric, box and mesh for each
    // cluster.
    const std::uint64_t tree =
        n.is_refined ? n.cells * 8 + triples + n.clusters * 3 * sizeof(ClusterNode) : n.cells * 4;
    const std::uint64_t cut = n.clusters * (24 + 80 + 24 + attributes);
    const std::uint64_t manifold = n.clusters * 2 * 84;
    const std::uint64_t refine = kept + tree + cut + manifold;
    const std::uint64_t collapse = n.cells * 12 +
                                   n.clusters * (sizeof(CollapseVertex) + attributes + 41) +
                                   n.clusters * 2 * 24;
    return ooc::MemoryBudget::kFixedBytes + std::max({accumulate, store, refine, collapse});
}

}  // namespace hewer::rsimp
