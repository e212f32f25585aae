// SPDX-License-Identifier: MIT
#include "rsimp/octree_fusion.h"

#include <algorithm>
#include <vector>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/block_collapse.h"
#include "rsimp/block_refiner.h"
#include "rsimp/cell_block.h"
#include "rsimp/key_cut.h"

namespace hewer::rsimp {

using cluster::CellBlocks;

namespace {

constexpr unsigned kLevels = 3;

/// A box of the octree with more than one occupied child, as a run of cells of its block.
struct Box {
    double key;  ///< error for each vertex saved, never below the keys of the boxes inside
    std::uint32_t first;
    std::uint32_t last;
    std::uint32_t n_saved;  ///< vertices, once the boxes inside are fused
    std::uint32_t unused;
};

ClusterSums sum_box(const CellBlock& block, std::uint32_t first, std::uint32_t last) {
    ClusterSums sums;
    for (std::uint32_t i = first; i < last; ++i) sums.add(block.cells[i]);
    return sums;
}

double fused_error(const CellBlock& block, std::uint32_t first, std::uint32_t last) {
    const ClusterSums sums = sum_box(block, first, last);
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    return priority(sums, representative(sums, eigen), Priority::Quadric);
}

/// All boxes inside a block, level by level.
std::vector<Box> boxes_in(const CellBlock& block) {
    const auto n = static_cast<std::uint32_t>(block.codes.size());
    const std::vector<std::uint64_t>& codes = block.codes;
    std::vector<double> inner(n);  // the largest key of the boxes around each cell so far
    std::vector<Box> boxes;
    for (unsigned level = 1; level <= kLevels; ++level) {
        for (std::uint32_t first = 0; first < n;) {
            const std::uint64_t prefix = codes[first] >> (3 * level);
            std::uint32_t last = first + 1;
            std::uint32_t n_children = 1;
            while (last < n && codes[last] >> (3 * level) == prefix) {
                if (codes[last] >> (3 * level - 3) != codes[last - 1] >> (3 * level - 3)) {
                    ++n_children;
                }
                ++last;
            }
            if (n_children > 1) {
                double key = fused_error(block, first, last) / (last - first - 1);
                for (std::uint32_t i = first; i < last; ++i) key = std::max(key, inner[i]);
                std::fill(inner.begin() + first, inner.begin() + last, key);
                boxes.push_back({key, first, last, n_children - 1, 0});
            }
            first = last;
        }
    }
    return boxes;
}

}  // namespace

ClusterMesh fuse_blocks(ooc::Context& context, const CellBlocks& cells, std::uint64_t n_clusters) {
    if (n_clusters >= cells.n_cells()) return cells_as_clusters(context, cells);
    std::uint64_t most = 0;
    const auto bytes_for = [&](std::size_t b) {
        const CellBlocks::Block& first = cells.blocks[b];
        const CellBlocks::Block& last = cells.blocks[b + 1];
        const std::uint64_t n = last.first_cell - first.first_cell;
        return CellBlock::bytes_for(n, last.first_face - first.first_face,
                                    !cells.attributes.empty()) +
               n * (2 * sizeof(Box) + sizeof(CollapseVertex));
    };
    for (std::size_t b = 0; b < cells.n_blocks(); ++b) most = std::max(most, bytes_for(b));
    const std::size_t n_alive = most_blocks_alive(context, most);

    ooc::Spool<Box> boxes(context, "octree boxes");
    std::vector<std::uint64_t> first_box{0};
    context.workers().in_order(
        cells.n_blocks(), n_alive,
        [&](std::uint64_t b) {
            const ooc::Reservation bytes =
                context.budget().reserve("a block of cells", bytes_for(b));
            return boxes_in(load_block(cells, b));
        },
        [&](std::uint64_t, const std::vector<Box>& more) {
            boxes.append(more);
            first_box.push_back(boxes.size());
            context.check_stop();
        });
    // Cheapest first until enough is saved. A box's own saving counts on top of those inside it,
    // which have no larger keys.
    const double most_key = weighted_quantile(
        boxes, cells.n_cells() - n_clusters, [](const Box& box) { return box.key; },
        [](const Box& box) { return std::uint64_t{box.n_saved}; });

    const Vec3 origin = cluster_origin(cells);
    return build_cluster_mesh(context, cells, n_alive, [&](std::size_t b) {
        const ooc::Reservation bytes = context.budget().reserve("a block of cells", bytes_for(b));
        const CellBlock block = load_block(cells, b);
        const auto n = static_cast<std::uint32_t>(block.cells.size());
        std::vector<std::uint32_t> fused_until(n);  // end of the largest fused box from here
        ooc::SpoolReader<Box> reader(boxes, first_box[b], first_box[b + 1]);
        while (const Box* box = reader.next()) {
            if (box->key > most_key) continue;
            fused_until[box->first] = std::max(fused_until[box->first], box->last);
        }
        BlockClusters clusters;
        clusters.cluster_of_cell.reserve(n);
        for (std::uint32_t first = 0; first < n;) {
            const std::uint32_t last = std::max(first + 1, fused_until[first]);
            clusters.cluster_of_cell.resize(last,
                                            static_cast<std::uint32_t>(clusters.vertices.size()));
            clusters.add(sum_box(block, first, last), block.origin - origin, last - first);
            if (!block.attributes.empty()) {
                cluster::CellAttributes sum{};
                for (std::uint32_t i = first; i < last; ++i) sum += block.attributes[i];
                clusters.attributes.push_back(sum);
            }
            first = last;
        }
        return clusters;
    });
}

}  // namespace hewer::rsimp
