// SPDX-License-Identifier: MIT
/// The cluster tree of one block of cells, RSimp-style: clusters are split in two, and
/// cells and faces are partitioned in place, so that every cluster owns a contiguous subrange of
/// either (Brodsky & Watson 2000; Choudhury & Watson 2002).
#pragma once

#include <cstdint>
#include <vector>

#include "rsimp/cell_block.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

/// Offsets are into the block's cells and faces.
struct ClusterNode {
    double key = 0;  ///< split priority, never above the parent's: the tree is monotone
    SplitPlane plane;
    std::uint32_t cell_begin = 0;
    std::uint32_t cell_end = 0;
    /// Faces with at least two corners in this cluster. After a split those come first whose
    /// corners the split has separated (they stay for good), then the faces of the first child,
    /// then of the second.
    std::uint32_t face_begin = 0;
    std::uint32_t face_end = 0;
    std::uint32_t first_child = 0;  ///< children are first_child and first_child + 1; 0: a leaf
    bool is_disconnected = false;   ///< to be split by components instead of by the plane
};

/// A tree over the cells of a block and over the faces that have at least two corners among them.
/// Blocks are independent of each other: what they share is only the threshold down to which they
/// are split. Memory: 100 bytes a node and 8 a cell beside the block.
class ClusterTree {
  public:
    ClusterTree(CellBlock block, Priority priority);

    /// Splits every leaf whose key is above `threshold`, and their children. May be called again
    /// with a lower threshold.
    void grow(double threshold);

    [[nodiscard]] const CellBlock& block() const { return block_; }
    /// Where the cell with an id is now, as a place in block().cells.
    [[nodiscard]] const std::vector<std::uint32_t>& place_of_id() const { return place_of_id_; }
    [[nodiscard]] const std::vector<ClusterNode>& nodes() const { return nodes_; }
    [[nodiscard]] std::uint64_t n_leaves() const { return (nodes_.size() + 1) / 2; }
    /// Calls visit(node) for each cluster of the cut at `threshold`: nodes that are not split or
    /// whose key is not above it. First children first, so that neighbours get neighbouring
    /// numbers.
    template <typename Visit>
    void for_each_cluster(double threshold, const Visit& visit) const {
        if (nodes_.empty()) return;
        std::vector<std::uint32_t> stack{0};
        while (!stack.empty()) {
            const ClusterNode& node = nodes_[stack.back()];
            stack.pop_back();
            if (node.first_child != 0 && node.key > threshold) {
                stack.push_back(node.first_child + 1);
                stack.push_back(node.first_child);
            } else {
                visit(node);
            }
        }
    }

  private:
    [[nodiscard]] ClusterSums sum(const ClusterNode& node) const;
    void add_node(const ClusterNode& subranges, double parent_key);
    void split(std::uint32_t index);
    std::uint32_t partition_by_plane(const ClusterNode& node);
    std::uint32_t partition_by_components(const ClusterNode& node);
    std::uint32_t label_components(const ClusterNode& node);
    void swap_cells(std::uint32_t i, std::uint32_t j);

    CellBlock block_;
    Priority priority_;
    std::vector<std::uint32_t> place_of_id_;
    std::vector<ClusterNode> nodes_;
    std::vector<std::uint32_t> labels_;  // scratch of label_components
};

}  // namespace hewer::rsimp
