// SPDX-License-Identifier: MIT
#include "rsimp/block_fusion.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/cluster_mesh_builder.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/key_selection.h"

namespace hewer::rsimp {

using cluster::CellBlocks;
using cluster::CellRecord;

namespace {

/// A box of the octree with more than one occupied child.
struct Box {
    double key;       ///< error for each vertex saved, never below the keys of the boxes inside
    LocalCell first;  ///< in its block
    LocalCell n_cells;
    std::uint16_t n_saved;  ///< vertices, once the boxes inside are fused
    std::uint16_t level;
};
static_assert(sizeof(Box) == 16);

/// The boxes of one block.
class BoxTree {
  public:
    static std::uint64_t bytes_for(const LargestBlock& largest) {
        // A box has two children at least: there are fewer boxes than cells.
        return largest.n_cells * (sizeof(CellRecord) + sizeof(std::uint64_t) + 2 * sizeof(Box));
    }

    void load(ooc::Context& context, const CellBlocks& blocks, std::size_t b) {
        const std::uint64_t first = blocks.blocks[b].first_cell;
        const std::uint64_t n = blocks.blocks[b + 1].first_cell - first;
        cells_.resize(n);
        blocks.cells.read(first, std::span(cells_));
        codes_.resize(n);
        blocks.codes.read(first, std::span(codes_));
        // Runs of whole boxes, for the threads that a model of few blocks leaves idle.
        std::vector<std::vector<Box>> boxes_of_run((n + kRunCells - 1) / kRunCells);
        context.workers().for_ranges(boxes_of_run.size(), 1, [&](std::uint64_t run, std::uint64_t) {
            const std::size_t end = box_at_or_after((run + 1) * kRunCells);
            for (std::size_t i = box_at_or_after(run * kRunCells); i < end;) {
                i = sum_box(i, kFusionLevels, cluster::center_of(codes_[i]), boxes_of_run[run]).end;
            }
        });
        boxes_.clear();
        for (const auto& boxes : boxes_of_run) {
            boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
        }
    }
    /// By place; inner boxes before those around them.
    [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }

  private:
    static constexpr std::uint64_t kRunCells = 4096;

    struct Sum {
        ClusterSums sums;  // relative to the frame
        double key = 0;    // largest in the box
        std::size_t end = 0;
    };

    /// First cell of the first largest box that begins at cell `i` or later.
    [[nodiscard]] std::size_t box_at_or_after(std::size_t i) const {
        const unsigned shift = 3 * kFusionLevels;
        while (i > 0 && i < codes_.size() && codes_[i] >> shift == codes_[i - 1] >> shift) ++i;
        return std::min(i, codes_.size());
    }

    /// The box of `level` that begins with cell `begin`; it and those inside are added to `boxes`.
    /// Its sums are those of the boxes inside, so that each cell is converted once.
    Sum sum_box(std::size_t begin, unsigned level, const Vec3& frame,
                std::vector<Box>& boxes) const {
        if (level == 0) {
            CellRecord cell = cells_[begin];
            const Vec3 shift = cluster::center_of(codes_[begin]) - frame;
            for (std::size_t k = 0; k < 3; ++k) cell.mean[k] += static_cast<float>(shift[k]);
            Sum sum;
            sum.sums.add(cell);
            sum.end = begin + 1;
            return sum;
        }
        const std::uint64_t prefix = codes_[begin] >> (3 * level);
        Sum sum = sum_box(begin, level - 1, frame, boxes);
        std::uint16_t n_children = 1;
        while (sum.end < codes_.size() && codes_[sum.end] >> (3 * level) == prefix) {
            const Sum child = sum_box(sum.end, level - 1, frame, boxes);
            sum.sums += child.sums;
            sum.key = std::max(sum.key, child.key);
            sum.end = child.end;
            ++n_children;
        }
        if (n_children == 1) return sum;
        const cluster::Eigen3 eigen = cluster::eigen_decomposition(sum.sums.quadric.a);
        const double error = priority(sum.sums, representative(sum.sums, eigen), Priority::Quadric);
        const std::size_t n = sum.end - begin;
        sum.key = std::max(sum.key, error / static_cast<double>(n - 1));
        boxes.push_back({sum.key, static_cast<LocalCell>(begin), static_cast<LocalCell>(n),
                         static_cast<std::uint16_t>(n_children - 1),
                         static_cast<std::uint16_t>(level)});
        return sum;
    }

    std::vector<CellRecord> cells_;
    std::vector<std::uint64_t> codes_;
    std::vector<Box> boxes_;
};

/// The boxes of all blocks, block by block.
struct Boxes {
    ooc::Spool<Box> boxes;
    std::vector<std::uint64_t> first;  // by block, one more at the end
    std::uint64_t n_saved = 0;         // if all are fused
};

Boxes find_boxes(ooc::Context& context, const CellBlocks& blocks) {
    const BlocksInFlight in_flight(context, "boxes of a block",
                                   BoxTree::bytes_for(LargestBlock(blocks)));
    Boxes all;
    all.boxes = {context, "fusion boxes"};
    all.first.push_back(0);
    in_flight.sweep<BoxTree>(
        blocks.n_blocks(), [&](std::uint64_t b, BoxTree& tree) { tree.load(context, blocks, b); },
        [&](std::uint64_t, const BoxTree& tree) {
            for (const Box& box : tree.boxes()) all.n_saved += box.n_saved;
            all.boxes.append(tree.boxes());
            all.first.push_back(all.boxes.size());
        });
    return all;
}

/// The last box that is fused, in the order of the choice: cheapest first; at equal keys the inner
/// boxes first, so that a box's own saving counts only after theirs; then by place.
struct LastFused {
    double key = std::numeric_limits<double>::infinity();
    std::uint16_t level = 0;
    std::uint64_t place = 0;

    [[nodiscard]] bool covers(const Box& box, std::uint64_t at) const {
        return std::tie(box.key, box.level, at) <= std::tie(key, level, place);
    }
};

/// Precondition: 0 < n_saved <= boxes.n_saved.
LastFused choose_last(ooc::Context& context, const Boxes& boxes, std::uint64_t n_saved) {
    LastFused last;
    last.key = key_at_weight(
        context, boxes.boxes, n_saved, [](const Box& box) { return box.key; },
        [](const Box& box) { return std::uint64_t{box.n_saved}; });
    std::array<std::uint64_t, kFusionLevels + 1> saved_by_ties{};
    const auto for_each_box = [&](const auto& visit) {
        ooc::SpoolReader<Box> reader(boxes.boxes);
        for (std::uint64_t at = 0; const Box* box = reader.next(); ++at) visit(*box, at);
    };
    std::uint64_t missing = n_saved;
    for_each_box([&](const Box& box, std::uint64_t) {
        if (box.key < last.key) missing -= box.n_saved;
        if (box.key == last.key) saved_by_ties[box.level] += box.n_saved;
    });
    last.level = 1;
    while (saved_by_ties[last.level] < missing) missing -= saved_by_ties[last.level++];
    for_each_box([&](const Box& box, std::uint64_t at) {
        if (box.key != last.key || box.level != last.level || missing == 0) return;
        missing -= std::min<std::uint64_t>(missing, box.n_saved);
        last.place = at;
    });
    return last;
}

}  // namespace

ClusterMesh fuse_blocks(ooc::Context& context, const CellBlocks& blocks, std::uint64_t n_clusters) {
    if (n_clusters >= blocks.n_cells()) return cells_as_clusters(context, blocks);
    const Boxes boxes = find_boxes(context, blocks);
    const std::uint64_t n_saved = std::min(boxes.n_saved, blocks.n_cells() - n_clusters);
    const LastFused last = n_saved > 0 ? choose_last(context, boxes, n_saved) : LastFused{-1, 0, 0};
    return build_cluster_mesh(context, blocks, [&](std::size_t b, CellGroups& groups) {
        const std::uint64_t n_cells = blocks.blocks[b + 1].first_cell - blocks.blocks[b].first_cell;
        // By cell: the size of the largest fused box that begins there.
        std::vector<LocalCell> size(n_cells, 1);
        ooc::SpoolReader<Box> reader(boxes.boxes, boxes.first[b], boxes.first[b + 1]);
        for (std::uint64_t at = boxes.first[b]; const Box* box = reader.next(); ++at) {
            if (last.covers(*box, at)) size[box->first] = std::max(size[box->first], box->n_cells);
        }
        for (std::uint64_t i = 0; i < n_cells; i += size[i]) {
            groups.begins.push_back(static_cast<LocalCell>(i));
        }
    });
}

}  // namespace hewer::rsimp
