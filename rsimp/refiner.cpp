// SPDX-License-Identifier: MIT
#include "rsimp/refiner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ooc/parallel.h"

namespace hewer::rsimp {

using cluster::CellStore;
using cluster::CellTriple;

namespace {

/// Octree boxes with at most `most` cells, as runs of Morton order.
std::vector<ClusterTree> make_blocks(const ooc::Array<std::uint64_t>& codes, std::uint64_t most) {
    struct Box {
        std::uint64_t first;
        std::uint64_t last;
        int shift;  // bits below the box's prefix
    };
    std::vector<ClusterTree> blocks;
    std::vector<Box> open{{0, codes.size(), 63}};
    while (!open.empty()) {
        const Box box = open.back();
        open.pop_back();
        if (box.first == box.last) continue;
        if (box.last - box.first <= most || box.shift == 0) {
            blocks.emplace_back(box.first, box.last);
            continue;
        }
        const int shift = box.shift - 3;
        std::uint64_t last = box.last;
        for (int octant = 7; octant >= 0; --octant) {  // pushed last to first: popped in order
            const auto begin = std::partition_point(
                codes.begin() + box.first, codes.begin() + last,
                [&](std::uint64_t code) { return static_cast<int>(code >> shift & 7) < octant; });
            const auto first = static_cast<std::uint64_t>(begin - codes.begin());
            open.push_back({first, last, shift});
            last = first;
        }
    }
    return blocks;
}

/// Faces by the block that has two of their corners; those that have none go to the end.
void sort_faces_into_blocks(ooc::Context& context, CellStore& store,
                            std::vector<ClusterTree>& blocks) {
    ooc::Array<std::uint32_t> block_of(context.budget(), "blocks of cells", store.codes.size());
    for (std::uint32_t b = 0; b < blocks.size(); ++b) {
        std::fill(block_of.begin() + blocks[b].first_cell(),
                  block_of.begin() + blocks[b].last_cell(), b);
    }
    const auto owner = [&](const CellTriple& face) -> std::uint64_t {
        const std::uint32_t b0 = block_of[face[0]];
        const std::uint32_t b1 = block_of[face[1]];
        const std::uint32_t b2 = block_of[face[2]];
        if (b0 == b1 || b0 == b2) return b0;
        return b1 == b2 ? b1 : blocks.size();
    };
    std::vector<std::uint64_t> start(blocks.size() + 2);
    for (const CellTriple& face : store.triangles) ++start[owner(face) + 1];
    for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b].set_faces(start[b], start[b + 1]);
    ooc::Array<CellTriple> sorted(context.budget(), "triangles by block", store.triangles.size());
    for (const CellTriple& face : store.triangles) sorted[start[owner(face)]++] = face;
    store.triangles = std::move(sorted);
}

}  // namespace

Refiner::Refiner(ooc::Context& context, CellStore& store, Priority priority)
    : context_(context),
      store_(store),
      priority_(priority),
      position_(context.budget(), "cell positions", store.codes.size()),
      trees_(make_blocks(store.codes, kBlockCells)) {
    sort_faces_into_blocks(context, store, trees_);
    for (std::uint64_t i = 0; i < position_.size(); ++i) {
        position_[i] = static_cast<std::uint32_t>(i);
    }
}

void Refiner::reserve_nodes() {
    std::uint64_t bytes = 0;
    for (const ClusterTree& tree : trees_) bytes += tree.nodes().capacity() * sizeof(ClusterNode);
    node_bytes_.release();
    node_bytes_ = context_.budget().reserve("cluster trees", bytes);
}

void Refiner::grow(double threshold) {
    const TreeContext tree_context{store_, position_.span(), priority_};
    context_.workers().for_ranges(trees_.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) {
            trees_[i].grow(tree_context, threshold);
            context_.check_stop();
        }
    });
    reserve_nodes();
}

std::uint64_t Refiner::n_leaves() const {
    std::uint64_t n = 0;
    for (const ClusterTree& tree : trees_) n += tree.n_leaves();
    return n;
}

double Refiner::cut_threshold(std::uint64_t n_clusters) const {
    if (n_clusters <= trees_.size()) return std::numeric_limits<double>::infinity();
    std::vector<double> keys;
    for (const ClusterTree& tree : trees_) {
        for (const ClusterNode& node : tree.nodes()) {
            if (node.first_child != 0) keys.push_back(node.key);
        }
    }
    const std::uint64_t n_splits = n_clusters - trees_.size();
    if (n_splits >= keys.size()) return -1;
    // Nodes whose key is above the (n_splits + 1)-th largest are split: at most n_splits of them.
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(n_splits);
    std::nth_element(keys.begin(), nth, keys.end(), std::greater<>());
    return *nth;
}

Clusters Refiner::refine_to_count(std::uint64_t n_clusters) {
    // Keys fall with about the cube of the number of clusters on a smooth surface (area times
    // squared distance), more slowly on a noisy one. Steps err on the side of too few splits: one
    // round more costs less than clusters that the cut throws away again.
    grow(std::numeric_limits<double>::infinity());
    double largest = 0;
    for (const ClusterTree& tree : trees_) {
        if (std::isfinite(tree.nodes()[0].key)) largest = std::max(largest, tree.nodes()[0].key);
    }
    double threshold = largest / 8;
    std::uint64_t before = 0;
    while (threshold > 0) {
        grow(threshold);
        const std::uint64_t n = n_leaves();
        context_.advance(std::min(n, n_clusters) - std::min(before, n_clusters));
        before = n;
        if (n >= n_clusters) break;
        const double missing = static_cast<double>(n) / static_cast<double>(n_clusters);
        threshold *= std::clamp(missing * std::sqrt(missing), 1e-3, 0.9);
        if (threshold < largest * 1e-24) threshold = 0;
    }
    if (threshold == 0) grow(0);
    return cut(cut_threshold(n_clusters));
}

Clusters Refiner::refine_to_key(double key) {
    grow(key);
    return cut(key);
}

Clusters Refiner::cut(double threshold) {
    std::vector<std::uint64_t> first(trees_.size() + 1);
    for (std::size_t i = 0; i < trees_.size(); ++i) {
        std::uint64_t n = 0;
        trees_[i].for_each_cluster(threshold, [&](const ClusterNode&) { ++n; });
        first[i + 1] = first[i] + n;
    }
    Clusters clusters = make_clusters(context_, store_, first.back());
    context_.workers().for_ranges(trees_.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) {
            const ClusterTree& tree = trees_[i];
            const Vec3 shift = tree.frame_origin(store_) - clusters.origin;
            std::uint64_t k = first[i];
            tree.for_each_cluster(threshold, [&](const ClusterNode& node) {
                store_cluster(clusters, k, tree.sum(store_, node, false), shift);
                for (std::uint32_t c = node.cell_begin; c < node.cell_end; ++c) {
                    const std::uint32_t id = store_.cells[tree.first_cell() + c].id;
                    clusters.cluster_of_cell[id] = static_cast<std::uint32_t>(k);
                    if (!clusters.attributes.empty()) {
                        clusters.attributes[k] += store_.attributes[id];
                    }
                }
                ++k;
            });
        }
    });
    return clusters;
}

}  // namespace hewer::rsimp
