// SPDX-License-Identifier: MIT
/// The cluster tree of one block of the cell store, RSimp-style: clusters are split in two, and
/// cells and faces are partitioned in place, so that every cluster owns a contiguous subrange of
/// either (Brodsky & Watson 2000; Choudhury & Watson 2002).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/cell_store.h"
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

/// What the blocks of a run share.
struct TreeContext {
    cluster::CellStore& store;
    /// position[id]: where cell `id` is now, as an index into store.cells.
    std::span<std::uint32_t> position;
    Priority priority = Priority::Quadric;
};

/// A tree over the cells [first_cell, last_cell) of the store, a run of Morton order, and over the
/// faces that have at least two corners among them. Blocks are independent of each other: what they
/// share is only the threshold down to which they are split.
class ClusterTree {
  public:
    ClusterTree(std::uint64_t first_cell, std::uint64_t last_cell)
        : first_cell_(first_cell), last_cell_(last_cell) {}

    /// The faces that are this block's: a subrange of store.triangles. Once, before grow().
    void set_faces(std::uint64_t first, std::uint64_t last) {
        first_face_ = first;
        last_face_ = last;
    }

    /// Splits every leaf whose key is above `threshold`, and their children. May be called again
    /// with a lower threshold. One thread; permutes this block's cells and faces only.
    void grow(const TreeContext& context, double threshold);

    [[nodiscard]] const std::vector<ClusterNode>& nodes() const { return nodes_; }
    [[nodiscard]] std::uint64_t first_cell() const { return first_cell_; }
    [[nodiscard]] std::uint64_t last_cell() const { return last_cell_; }
    [[nodiscard]] std::uint64_t n_leaves() const { return (nodes_.size() + 1) / 2; }
    /// Where the block's coordinates start, in cells from the lattice origin: the centre of a cell.
    [[nodiscard]] Vec3 frame_origin(const cluster::CellStore& store) const;

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

    /// Sums over a cluster, in the block's frame.
    [[nodiscard]] ClusterSums sum(const cluster::CellStore& store, const ClusterNode& node,
                                  bool with_normals) const;

  private:
    void move_cells_to_frame(cluster::CellStore& store) const;
    void add_node(const TreeContext& context, const ClusterNode& subranges, double parent_key);
    void split(const TreeContext& context, std::uint32_t index);
    std::uint32_t partition_by_plane(const TreeContext& context, const ClusterNode& node);
    std::uint32_t partition_by_components(const TreeContext& context, const ClusterNode& node);
    std::uint32_t label_components(const TreeContext& context, const ClusterNode& node);
    void swap_cells(const TreeContext& context, std::uint32_t i, std::uint32_t j);

    std::uint64_t first_cell_;
    std::uint64_t last_cell_;
    std::uint64_t first_face_ = 0;
    std::uint64_t last_face_ = 0;
    std::vector<ClusterNode> nodes_;
    std::vector<std::uint32_t> labels_;  // scratch of label_components
};

}  // namespace hewer::rsimp
