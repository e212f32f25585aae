// SPDX-License-Identifier: MIT
/// Where the surface is in the cells of a block, and in their neighbours in other blocks.
#pragma once

#include <cstdint>
#include <vector>

#include "cluster/cell_blocks.h"
#include "ooc/spool_cache.h"
#include "rsimp/cell_mean.h"

namespace hewer::rsimp {

/// The means of the cells of one block, in cells from the lattice origin, and of single ones of
/// others. Memory: kBytesPerCell for those of the block, kCacheBytes for the others.
class CellMeans {
  public:
    static constexpr std::uint64_t kBytesPerCell =
        sizeof(cluster::CellRecord) + sizeof(std::uint64_t) + sizeof(Vec3) + sizeof(float);
    static constexpr std::uint64_t kCacheBytes =
        ooc::SpoolCache<std::uint64_t>::kBytes + ooc::SpoolCache<cluster::CellRecord>::kBytes;

    CellMeans(const cluster::CellBlocks& cells, std::size_t block)
        : first_(cells.blocks[block].first_cell), codes_(cells.codes), records_(cells.cells) {
        const std::uint64_t n = cells.blocks[block + 1].first_cell - first_;
        std::vector<cluster::CellRecord> records(n);
        std::vector<std::uint64_t> codes(n);
        cells.cells.read(first_, records);
        cells.codes.read(first_, codes);
        means_.reserve(n);
        areas_.reserve(n);
        for (std::uint64_t i = 0; i < n; ++i) {
            means_.push_back(mean_of(codes[i], records[i]));
            areas_.push_back(records[i].area);
        }
    }
    [[nodiscard]] bool has(std::uint64_t cell) const { return cell - first_ < means_.size(); }
    [[nodiscard]] std::uint64_t size() const { return means_.size(); }
    [[nodiscard]] std::uint64_t first() const { return first_; }
    [[nodiscard]] double area(std::uint64_t cell) const { return areas_[cell - first_]; }
    Vec3 at(std::uint64_t cell) {
        if (cell - first_ < means_.size()) return means_[cell - first_];
        return mean_of(codes_.at(cell), records_.at(cell));
    }

  private:
    std::uint64_t first_;
    std::vector<Vec3> means_;
    std::vector<float> areas_;
    ooc::SpoolCache<std::uint64_t> codes_;
    ooc::SpoolCache<cluster::CellRecord> records_;
};

}  // namespace hewer::rsimp
