// SPDX-License-Identifier: MIT
#include "rsimp/block_refiner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/block_collapse.h"
#include "rsimp/key_cut.h"

namespace hewer::rsimp {

using cluster::CellBlocks;

namespace {

// One of so many blocks is grown first, to see how far.
constexpr std::size_t kSampleStride = 8;
constexpr std::size_t kLeastSample = 4;
// Of a tree (up to a node for two cells, in a vector that doubles), and of the clusters made of it.
constexpr std::uint64_t kBytesPerCell = 8 + sizeof(ClusterNode) + sizeof(CollapseVertex) / 2;

std::uint64_t bytes_of_block(const CellBlocks& cells, std::size_t b) {
    const CellBlocks::Block& first = cells.blocks[b];
    const CellBlocks::Block& last = cells.blocks[b + 1];
    const std::uint64_t n = last.first_cell - first.first_cell;
    return CellBlock::bytes_for(n, last.first_face - first.first_face, !cells.attributes.empty()) +
           n * kBytesPerCell;
}

std::size_t most_alive(ooc::Context& context, const CellBlocks& cells) {
    std::uint64_t most = 0;
    for (std::size_t b = 0; b < cells.n_blocks(); ++b) {
        most = std::max(most, bytes_of_block(cells, b));
    }
    return most_blocks_alive(context, most);
}

void add_attributes(BlockClusters& clusters, const CellBlock& block,
                    const std::vector<std::uint32_t>& ids) {
    if (block.attributes.empty()) return;
    cluster::CellAttributes sum{};
    for (const std::uint32_t id : ids) sum += block.attributes[id];
    clusters.attributes.push_back(sum);
}

}  // namespace

struct BlockRefiner::Grown {
    ooc::Reservation bytes;
    ClusterTree tree;
};

BlockRefiner::BlockRefiner(ooc::Context& context, const CellBlocks& cells, Priority priority)
    : context_(context),
      cells_(cells),
      priority_(priority),
      n_alive_(most_alive(context, cells)),
      kept_(cells.n_blocks()) {}

BlockRefiner::~BlockRefiner() = default;

std::uint64_t BlockRefiner::bytes_for(std::size_t b) const {
    return bytes_of_block(cells_, b);
}

/// The tree of a block, grown down to the threshold at least.
std::unique_ptr<BlockRefiner::Grown> BlockRefiner::take(std::size_t b, double threshold) {
    std::unique_ptr<Grown> grown = std::move(kept_[b]);
    if (!grown) {
        ooc::Reservation bytes = context_.budget().reserve("a block of cells", bytes_for(b));
        grown = std::make_unique<Grown>(
            Grown{std::move(bytes), ClusterTree(load_block(cells_, b), priority_)});
    }
    grown->tree.grow(std::max(threshold, 0.0));  // single cells have key 0
    context_.check_stop();
    return grown;
}

void BlockRefiner::put_back(std::size_t b, std::unique_ptr<Grown> grown) {
    // Half of the memory is left to those who need it.
    if (context_.budget().available() > context_.budget().limit() / 2) kept_[b] = std::move(grown);
}

/// Grows some blocks; their splits' keys above the threshold go to `keys`. Returns the number of
/// leaves.
std::uint64_t BlockRefiner::grow(const std::vector<std::size_t>& blocks, double threshold,
                                 ooc::Spool<double>* keys) {
    std::uint64_t n_leaves = 0;
    context_.workers().in_order(
        blocks.size(), n_alive_,
        [&](std::uint64_t i) {
            std::unique_ptr<Grown> grown = take(blocks[i], threshold);
            Keys found;
            for (const ClusterNode& node : grown->tree.nodes()) {
                if (node.first_child != 0 && node.key > threshold) found.push_back(node.key);
            }
            put_back(blocks[i], std::move(grown));
            return found;
        },
        [&](std::uint64_t, const Keys& found) {
            n_leaves += found.size() + 1;
            if (keys != nullptr) keys->append(found);
        });
    return n_leaves;
}

/// A threshold at which the blocks have at least `n_clusters` leaves, if they can; lower than the
/// given one, or that. `keys` receives the keys above it.
double BlockRefiner::threshold_for(const std::vector<std::size_t>& blocks, std::uint64_t n_clusters,
                                   double threshold, ooc::Spool<double>* keys) {
    // Keys fall with about the cube of the number of clusters on a smooth surface (area times
    // squared distance), more slowly on a noisy one. Steps err on the side of too few splits: one
    // round more costs less than clusters that the cut throws away again.
    const double least = threshold * 1e-24;
    for (;;) {
        if (keys != nullptr) *keys = {context_, "split keys"};
        const std::uint64_t n = grow(blocks, threshold, keys);
        if (n >= n_clusters || threshold == 0) return threshold;
        const double missing = static_cast<double>(n) / static_cast<double>(n_clusters);
        threshold *= std::clamp(missing * std::sqrt(missing), 1e-3, 0.9);
        if (threshold < least) threshold = 0;
    }
}

ClusterMesh BlockRefiner::refine_to_count(std::uint64_t n_clusters) {
    const std::size_t n_blocks = cells_.n_blocks();
    if (n_clusters <= n_blocks) return cut(std::numeric_limits<double>::infinity());
    std::vector<std::size_t> all(n_blocks);
    std::iota(all.begin(), all.end(), std::size_t{0});
    const std::size_t n_sample =
        std::min(n_blocks, std::max(kLeastSample, n_blocks / kSampleStride));
    std::vector<std::size_t> sample;
    std::uint64_t sample_cells = 0;
    for (std::size_t i = 0; i < n_sample; ++i) {
        const std::size_t b = (2 * i + 1) * n_blocks / (2 * n_sample);
        sample.push_back(b);
        sample_cells += cells_.blocks[b + 1].first_cell - cells_.blocks[b].first_cell;
    }
    double largest = 0;
    for (const std::size_t b : sample) {
        std::unique_ptr<Grown> grown = take(b, std::numeric_limits<double>::infinity());
        const double key = grown->tree.nodes()[0].key;
        if (std::isfinite(key)) largest = std::max(largest, key);
        put_back(b, std::move(grown));
    }
    const double share = static_cast<double>(sample_cells) / static_cast<double>(cells_.n_cells());
    const auto n_in_sample =
        static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(n_clusters)));
    const double start = threshold_for(sample, n_in_sample, largest / 8, nullptr);
    ooc::Spool<double> keys;
    threshold_for(all, n_clusters, start, &keys);
    // Nodes whose key is above the (n_splits + 1)-th largest are split: at most n_splits of them.
    const std::uint64_t n_splits = n_clusters - n_blocks;
    const double threshold =
        n_splits >= keys.size() ? -1 : nth_smallest(keys, keys.size() - n_splits - 1);
    keys.release();
    return cut(threshold);
}

ClusterMesh BlockRefiner::refine_to_key(double key) {
    return cut(key);
}

ClusterMesh BlockRefiner::cut(double threshold) {
    const Vec3 origin = cluster_origin(cells_);
    return build_cluster_mesh(context_, cells_, n_alive_, [&](std::size_t b) {
        std::unique_ptr<Grown> grown = take(b, threshold);
        const CellBlock& block = grown->tree.block();
        const Vec3 shift = block.origin - origin;
        BlockClusters clusters;
        clusters.cluster_of_cell.resize(block.cells.size());
        std::vector<std::uint32_t> ids;
        grown->tree.for_each_cluster(threshold, [&](const ClusterNode& node) {
            const auto k = static_cast<std::uint32_t>(clusters.vertices.size());
            ids.clear();
            for (std::uint32_t i = node.cell_begin; i < node.cell_end; ++i) {
                ids.push_back(block.cells[i].id);
            }
            const ClusterSums sums = sum_cells(block, grown->tree.place_of_id(), ids);
            clusters.add(sums, shift, static_cast<std::uint32_t>(ids.size()));
            add_attributes(clusters, block, ids);
            for (const std::uint32_t id : ids) clusters.cluster_of_cell[id] = k;
        });
        put_back(b, std::move(grown));
        return clusters;
    });
}

ClusterMesh cells_as_clusters(ooc::Context& context, const CellBlocks& cells) {
    const Vec3 origin = cluster_origin(cells);
    return build_cluster_mesh(context, cells, most_alive(context, cells), [&](std::size_t b) {
        const ooc::Reservation bytes =
            context.budget().reserve("a block of cells", bytes_of_block(cells, b));
        CellBlock block = load_block(cells, b);
        BlockClusters clusters;
        for (std::uint32_t i = 0; i < block.cells.size(); ++i) {
            ClusterSums sums;
            sums.add(block.cells[i]);
            clusters.add(sums, block.origin - origin, 1);
            clusters.cluster_of_cell.push_back(i);
        }
        clusters.attributes = std::move(block.attributes);
        return clusters;
    });
}

}  // namespace hewer::rsimp
