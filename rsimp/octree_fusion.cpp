// SPDX-License-Identifier: MIT
#include "rsimp/octree_fusion.h"

#include <algorithm>
#include <vector>

#include "ooc/parallel.h"
#include "ooc/vec3.h"

namespace hewer::rsimp {

using cluster::CellRecord;
using cluster::CellStore;

namespace {

constexpr unsigned kLevels = 3;

/// A box of the octree with more than one occupied child.
struct Box {
    double key;  ///< error for each vertex saved, never below the keys of the boxes inside
    std::uint32_t first;
    std::uint32_t last;
    std::uint32_t n_saved;  ///< vertices, once the boxes inside are fused
    std::uint32_t level;
};

ClusterSums sum_box(const CellStore& store, std::uint64_t first, std::uint64_t last) {
    const Vec3 origin = store.center(first);
    ClusterSums sums;
    for (std::uint64_t i = first; i < last; ++i) {
        CellRecord cell = store.cells[i];
        const Vec3 shift = store.center(i) - origin;
        for (std::size_t k = 0; k < 3; ++k) cell.mean[k] += static_cast<float>(shift[k]);
        sums.add(cell);
    }
    return sums;
}

double fused_error(const CellStore& store, std::uint64_t first, std::uint64_t last) {
    const ClusterSums sums = sum_box(store, first, last);
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    return priority(sums, representative(sums, eigen), Priority::Quadric);
}

/// The boxes of one level in Morton order. `inner[i]` is the largest key of the boxes around cell i
/// so far.
std::vector<Box> boxes_of_level(ooc::Context& context, const CellStore& store, unsigned level,
                                ooc::Array<double>& inner) {
    std::vector<Box> boxes;
    const std::uint64_t n = store.codes.size();
    for (std::uint64_t first = 0; first < n;) {
        const std::uint64_t prefix = store.codes[first] >> (3 * level);
        std::uint64_t last = first + 1;
        std::uint32_t n_children = 1;
        while (last < n && store.codes[last] >> (3 * level) == prefix) {
            if (store.codes[last] >> (3 * level - 3) != store.codes[last - 1] >> (3 * level - 3)) {
                ++n_children;
            }
            ++last;
        }
        if (n_children > 1) {
            boxes.push_back({0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                             n_children - 1, level});
        }
        first = last;
    }
    context.workers().for_ranges(boxes.size(), 512, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t b = begin; b < end; ++b) {
            Box& box = boxes[b];
            box.key = fused_error(store, box.first, box.last) / (box.last - box.first - 1);
            for (std::uint32_t i = box.first; i < box.last; ++i) {
                box.key = std::max(box.key, inner[i]);
            }
            std::fill(inner.begin() + box.first, inner.begin() + box.last, box.key);
        }
        context.check_stop();
    });
    return boxes;
}

}  // namespace

Clusters fuse_cells(ooc::Context& context, const CellStore& store, std::uint64_t n_clusters) {
    const std::uint64_t n_cells = store.codes.size();
    if (n_clusters >= n_cells) return clusters_from_cells(context, store);
    std::vector<Box> boxes;
    {
        ooc::Array<double> inner(context.budget(), "fusion keys", n_cells);
        for (unsigned level = 1; level <= kLevels; ++level) {
            const std::vector<Box> more = boxes_of_level(context, store, level, inner);
            boxes.insert(boxes.end(), more.begin(), more.end());
        }
    }
    // Cheapest first; at equal keys the inner boxes first, so that a box's own saving counts only
    // after theirs.
    std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
        if (a.key != b.key) return a.key < b.key;
        return a.level != b.level ? a.level < b.level : a.first < b.first;
    });
    // fused_until[i]: end of the largest fused box that begins with cell i.
    ooc::Array<std::uint32_t> fused_until(context.budget(), "fusion", n_cells);
    std::uint64_t n = n_cells;
    for (const Box& box : boxes) {
        if (n <= n_clusters) break;
        n -= box.n_saved;
        fused_until[box.first] = std::max(fused_until[box.first], box.last);
    }
    std::vector<std::uint32_t> starts;
    starts.reserve(n + 1);
    for (std::uint32_t i = 0; i < n_cells;) {
        starts.push_back(i);
        i = std::max(i + 1, fused_until[i]);
    }
    starts.push_back(static_cast<std::uint32_t>(n_cells));

    Clusters clusters = make_clusters(context, store, starts.size() - 1);
    context.workers().for_ranges(
        starts.size() - 1, 1 << 11, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t k = begin; k < end; ++k) {
                const std::uint32_t first = starts[k];
                store_cluster(clusters, k, sum_box(store, first, starts[k + 1]),
                              store.center(first) - clusters.origin);
                for (std::uint32_t i = first; i < starts[k + 1]; ++i) {
                    clusters.cluster_of_cell[i] = static_cast<std::uint32_t>(k);
                    if (!clusters.attributes.empty()) clusters.attributes[k] += store.attributes[i];
                }
            }
        });
    return clusters;
}

}  // namespace hewer::rsimp
