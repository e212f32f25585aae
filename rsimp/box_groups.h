// SPDX-License-Identifier: MIT
/// Octree boxes taken together until they are worth a block.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/cell_blocks.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// The largest octree boxes whose counts add up to at most `most` (or that are one of the given
/// boxes), as ranges of the boxes given: the first of each group, and the number of boxes at the
/// end. With smaller counts the groups can only grow together: they nest.
std::vector<std::size_t> group_boxes(std::span<const cluster::OctreeBox> boxes,
                                     std::span<const std::uint64_t> counts, std::uint64_t most);

/// Consecutive ranges of vertex ids.
class IdRanges {
  public:
    IdRanges() = default;
    /// first[i] is the first id of range i; the last entry ends the last range.
    explicit IdRanges(std::vector<VertexId> first) : first_(std::move(first)) {}

    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] VertexId begin(std::size_t range) const { return first_[range]; }
    [[nodiscard]] VertexId end(std::size_t range) const { return first_[range + 1]; }
    [[nodiscard]] std::size_t find(VertexId id) const;

  private:
    std::vector<VertexId> first_;
};

}  // namespace hewer::rsimp
