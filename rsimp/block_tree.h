// SPDX-License-Identifier: MIT
/// The cluster tree of one block of cells, RSimp-style: clusters are split in two, and cells are
/// partitioned in place, so that every cluster owns a contiguous subrange of them (Brodsky & Watson
/// 2000; Choudhury & Watson 2002).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cluster/cell_blocks.h"
#include "rsimp/block_cut.h"
#include "rsimp/cell_graph.h"
#include "rsimp/cluster_summary.h"

namespace hewer::rsimp {

/// Grows the tree of one block after the other, from cut to cut. Blocks are independent of each
/// other: what they share is only the threshold down to which they are split. What a cluster is
/// split into depends on its cells and the splits above it alone, so a cut does not depend on the
/// cuts that it was grown from. Nodes live only while they are open: a tree of any size takes no
/// memory of its own.
///
/// A part of the surface that lies in one cluster as a whole would vanish with it. What that costs
/// is not in its quadric, whose minimum is near all its planes: its key is at least that of all its
/// area moved by its size, or by the distance that it had from a level of detail that it vanished
/// from, and it is split at once into the four vertices that the simplest closed form has, or six.
///
/// Memory: bytes_for() the largest block. One thread.
class BlockTree {
    /// A cluster: cells_[begin .. end).
    struct Node {
        double key = 0;  ///< split priority, never above the parent's; 0 for a single cell
        SplitPlane plane;
        std::uint32_t begin = 0;
        std::uint32_t end = 0;
        bool is_disconnected = false;  ///< to be split by components instead of by the plane
        std::uint8_t n_due = 0;        ///< splits that go together: this one and some below
    };

  public:
    /// Of grow_by_splits(), on top; a heap that doubles.
    static constexpr std::uint64_t kBytesPerSplit = 2 * sizeof(Node);

    static constexpr std::uint64_t bytes_for(std::uint64_t n_cells, std::uint64_t n_faces,
                                             Priority priority, bool has_attribute_quadrics) {
        const std::uint64_t per_cell =
            sizeof(cluster::CellRecord) + sizeof(LocalCell) + sizeof(double) + sizeof(float) +
            (priority == Priority::NormalVariation ? sizeof(std::array<float, 3>) : 0) +
            (has_attribute_quadrics ? sizeof(cluster::CellAttributeQuadric) : 0);
        return n_cells * per_cell + CellGraph::bytes_for(n_cells, n_faces) +
               3 * ooc::SpoolReader<cluster::CellRecord>::kBufferBytes;
    }

    /// Splits every cluster of `cut` whose key is above `threshold`, and their children, and puts
    /// the cut that results in the place of the one before. Reads the block's cells and faces once.
    void grow_to_key(const cluster::CellBlocks& blocks, std::size_t block, Priority priority,
                     double threshold, BlockCut& cut);

    /// The same, but splits the cluster with the largest key `n_splits` times, or as often as the
    /// cells allow. kBytesPerSplit on top.
    void grow_by_splits(const cluster::CellBlocks& blocks, std::size_t block, Priority priority,
                        std::uint64_t n_splits, BlockCut& cut);

  private:
    void load(const cluster::CellBlocks& blocks, std::size_t block, Priority priority,
              const BlockCut& cut);
    void store(BlockCut& cut) const;
    [[nodiscard]] Node make_node(std::uint32_t begin, std::uint32_t end, double parent_key,
                                 std::uint8_t n_due);
    template <typename Visit>
    void for_each_root(const BlockCut& cut, const Visit& visit);
    std::array<Node, 2> split(const Node& node);
    std::uint32_t partition_by_plane(const Node& node);
    std::uint32_t partition_by_components(const Node& node);
    std::uint32_t label_components(std::uint32_t begin, std::uint32_t end);
    [[nodiscard]] bool is_closed_off(std::uint32_t begin, std::uint32_t end, bool across) const;
    [[nodiscard]] double cost_of_loss(std::uint32_t begin, std::uint32_t end) const;
    void swap_cells(std::uint32_t i, std::uint32_t j);

    Priority priority_ = Priority::Quadric;
    CellGraph graph_;
    /// In the order of the clusters; means in the block's frame, which begins at the centre of a
    /// cell; ids are places in the block.
    std::vector<cluster::CellRecord> cells_;
    std::vector<std::array<float, 3>> face_normals_;         // by place in the block
    std::vector<cluster::CellAttributeQuadric> attributes_;  // the same; empty: they do not count
    std::vector<float> vanished_;                            // the same; empty: nothing had
    std::vector<LocalCell> position_;  // by place in the block: where in cells_
    std::vector<double> split_keys_;   // by place in cells_: BlockCut::keys, or < 0
    std::vector<Node> open_;
    std::vector<std::uint32_t> labels_;
};

}  // namespace hewer::rsimp
