// SPDX-License-Identifier: MIT
#include "rsimp/block_refiner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "rsimp/block_tree.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cluster_mesh_builder.h"
#include "rsimp/key_selection.h"

namespace hewer::rsimp {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Every so many blocks are tried first, and this much farther than their share.
constexpr std::size_t kSampleStride = 8;
constexpr std::size_t kFewestSampled = 4;
constexpr double kSampleExcess = 1.25;
// From the threshold that the sample calls for to the first one for all blocks. Keys fall with the
// square to the cube of the number of clusters: that many splits in excess are cheaper than a sweep
// more.
constexpr double kMargin = 0.75;
constexpr double kExponent = 2.5;
// No key is below this part of the largest, but for rounding.
constexpr double kLeastKey = 1e-24;

}  // namespace

BlockRefiner::Cuts::Cuts(ooc::Context& context)
    : order(context, "cut cells"), begins(context, "cut clusters"), keys(context, "cut keys") {
    blocks.emplace_back();
}

void BlockRefiner::Cuts::read(std::size_t b, BlockCut& cut) const {
    const Block& first = blocks[b];
    const Block& last = blocks[b + 1];
    cut.order.resize(last.first_cell - first.first_cell);
    order.read(first.first_cell, std::span(cut.order));
    cut.begins.resize(last.first_split - first.first_split);
    begins.read(first.first_split, std::span(cut.begins));
    cut.keys.resize(last.first_split - first.first_split);
    keys.read(first.first_split, std::span(cut.keys));
    cut.threshold = first.threshold;
}

void BlockRefiner::Cuts::append(const BlockCut& cut) {
    order.append(cut.order);
    begins.append(cut.begins);
    keys.append(cut.keys);
    blocks.back().threshold = cut.threshold;
    blocks.push_back({order.size(), keys.size(), 0});
}

double BlockRefiner::Cuts::threshold() const {
    double highest = 0;
    for (std::size_t b = 0; b + 1 < blocks.size(); ++b) {
        highest = std::max(highest, blocks[b].threshold);
    }
    return highest;
}

BlockRefiner::BlockRefiner(ooc::Context& context, const cluster::CellBlocks& blocks,
                           Priority priority)
    : context_(context), blocks_(blocks), priority_(priority), cuts_(context) {
    for (std::size_t b = 0; b < blocks.n_blocks(); ++b) cuts_.append({});
}

/// grow(block, tree, cut) for every `stride`-th block; the cuts of the others stay. These are not
/// blocks of the loop: as some that are done at once they would be all that may wait for a slow
/// one.
template <typename Grow>
void BlockRefiner::sweep(std::size_t stride, std::uint64_t bytes_per_cell, const Grow& grow) {
    struct Work {
        BlockTree tree;
        BlockCut cut;
    };
    const LargestBlock largest(blocks_);
    const BlocksInFlight in_flight(
        context_, "cluster trees",
        BlockTree::bytes_for(largest.n_cells, largest.n_faces, priority_,
                             !blocks_.attribute_quadrics.empty()) +
            largest.n_cells * (2 * sizeof(LocalCell) + sizeof(double) + bytes_per_cell));
    Cuts grown(context_);
    BlockCut untouched;
    in_flight.sweep<Work>((blocks_.n_blocks() + stride - 1) / stride,
                          [&](std::uint64_t i, Work& work) {
                              cuts_.read(i * stride, work.cut);
                              grow(i * stride, work.tree, work.cut);
                          },
                          [&](std::uint64_t i, const Work& work) {
                              const std::uint64_t b = i * stride;
                              const std::uint64_t before =
                                  cuts_.blocks[b + 1].first_split - cuts_.blocks[b].first_split;
                              context_.advance(work.cut.keys.size() - before);
                              grown.append(work.cut);
                              for (std::size_t other = b + 1;
                                   other < std::min(b + stride, blocks_.n_blocks()); ++other) {
                                  cuts_.read(other, untouched);
                                  grown.append(untouched);
                              }
                          });
    cuts_ = std::move(grown);
}

void BlockRefiner::grow_to_key(double threshold) {
    sweep(1, 0, [&](std::size_t b, BlockTree& tree, BlockCut& cut) {
        if (cut.threshold > threshold) tree.grow_to_key(blocks_, b, priority_, threshold, cut);
    });
}

void BlockRefiner::grow_sample(std::uint64_t n_splits) {
    const double share =
        kSampleExcess * static_cast<double>(n_splits) / static_cast<double>(blocks_.n_cells());
    const std::size_t stride =
        std::clamp<std::size_t>(blocks_.n_blocks() / kFewestSampled, 1, kSampleStride);
    sweep(stride, BlockTree::kBytesPerSplit, [&](std::size_t b, BlockTree& tree, BlockCut& cut) {
        const auto n_cells =
            static_cast<double>(blocks_.blocks[b + 1].first_cell - blocks_.blocks[b].first_cell);
        const auto wanted = static_cast<std::uint64_t>(std::ceil(share * n_cells));
        tree.grow_by_splits(blocks_, b, priority_, wanted, cut);
    });
}

std::uint64_t BlockRefiner::n_keys_above(double key) const {
    std::uint64_t n = 0;
    ooc::SpoolReader<double> keys(cuts_.keys);
    for (auto piece = keys.next_piece(); !piece.empty(); piece = keys.next_piece()) {
        n += static_cast<std::uint64_t>(
            std::count_if(piece.begin(), piece.end(), [&](double k) { return k > key; }));
    }
    return n;
}

double BlockRefiner::nth_key(std::uint64_t n) {
    return key_at_weight(
        context_, cuts_.keys, cuts_.keys.size() - n, [](double key) { return key; },
        [](double) { return std::uint64_t{1}; });
}

void BlockRefiner::grow_to_splits(std::uint64_t n_splits) {
    if (cuts_.threshold() == kInfinity) {
        grow_sample(n_splits);
        const auto wanted =
            static_cast<std::uint64_t>(static_cast<double>(cuts_.keys.size()) / kSampleExcess);
        if (wanted < cuts_.keys.size()) grow_to_key(kMargin * nth_key(wanted));
    }
    // The exponent doubles from step to step: where few keys lie between two thresholds, as between
    // those of noise and of plane parts, that many small steps would be sweeps for nothing.
    double exponent = kExponent;
    double threshold = cuts_.threshold();
    const double least = std::isfinite(threshold) ? kLeastKey * threshold : 0;
    while (threshold > 0) {
        const std::uint64_t n = n_keys_above(threshold);
        if (n >= n_splits) return;
        const double there = static_cast<double>(n + blocks_.n_blocks()) /
                             static_cast<double>(n_splits + blocks_.n_blocks());
        threshold *= std::pow(std::clamp(there, 0.05, 0.95), exponent);
        if (!(threshold > least && std::isfinite(threshold))) threshold = 0;
        grow_to_key(threshold);
        exponent *= 2;
    }
}

ClusterMesh BlockRefiner::refine_to_count(std::uint64_t n_clusters) {
    if (n_clusters >= blocks_.n_cells()) return cells_as_clusters(context_, blocks_);
    if (n_clusters <= blocks_.n_blocks()) return make_clusters(kInfinity);
    const std::uint64_t n_splits = n_clusters - blocks_.n_blocks();
    grow_to_splits(n_splits);
    // Clusters whose key is above the (n_splits + 1)-th largest are split: at most n_splits of
    // them. Keys below the common threshold are not all there; if it gets to them, there are
    // exactly n_splits above it, or no more to be had.
    const double threshold = cuts_.threshold();
    return make_clusters(cuts_.keys.size() > n_splits ? std::max(threshold, nth_key(n_splits))
                                                      : threshold);
}

ClusterMesh BlockRefiner::refine_to_key(double key) {
    if (cuts_.threshold() > key) grow_to_key(key);
    return make_clusters(key);
}

ClusterMesh BlockRefiner::make_clusters(double threshold) {
    return build_cluster_mesh(context_, blocks_, [&](std::size_t b, CellGroups& groups) {
        BlockCut cut;
        cuts_.read(b, cut);
        groups.order = std::move(cut.order);
        groups.begins.push_back(0);
        for (std::size_t i = 0; i < cut.begins.size(); ++i) {
            if (cut.keys[i] > threshold) groups.begins.push_back(cut.begins[i]);
        }
    });
}

}  // namespace hewer::rsimp
