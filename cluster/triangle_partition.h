// SPDX-License-Identifier: MIT
/// Triangles in no useful order, brought into one: sorted into octree boxes.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "cluster/lattice.h"
#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "ooc/spool.h"

namespace hewer::cluster {

using LatticeTriangle = std::array<LatticePoint, 3>;

/// 64 boxes, two bits an axis, by the first corner: then the cells of triangles that follow each
/// other are near each other, and a table that does not hold all cells is spilled now and then
/// instead of all the time. Memory: a page and 18 KiB for each box; disk: 36 bytes a triangle.
class TrianglePartition {
  public:
    explicit TrianglePartition(ooc::Context& context);

    /// One thread.
    void add(const LatticeTriangle& triangle) {
        std::vector<LatticeTriangle>& waiting = waiting_[box_of(triangle)];
        waiting.push_back(triangle);
        if (waiting.size() == kPiece) flush(box_of(triangle));
    }
    /// After the last.
    void finish();

    /// The next triangles, box by box; false at the end. Any thread.
    bool next(std::vector<LatticeTriangle>& triangles);

  private:
    static constexpr std::size_t kPiece = 512;
    static constexpr std::size_t kBoxes = 64;
    static std::size_t box_of(const LatticeTriangle& t) {
        constexpr unsigned kShift = 30;
        return t[0][0] >> kShift | (t[0][1] >> kShift) << 2 | (t[0][2] >> kShift) << 4;
    }
    void flush(std::size_t box);

    std::array<ooc::Spool<LatticeTriangle>, kBoxes> boxes_;
    std::array<std::vector<LatticeTriangle>, kBoxes> waiting_;
    struct Piece {
        std::uint32_t box;
        std::uint32_t n;
        std::uint64_t first;
    };
    std::vector<Piece> pieces_;
    std::array<std::atomic<std::uint32_t>, kBoxes> n_unread_{};  // pieces, by box
    std::atomic<std::size_t> next_{0};
};

/// What a pass over the triangles met, beside those that were added.
struct PartitionFindings {
    InputDefects defects;
};

/// The triangles of a soup. One pass. Throws FormatError for a corner outside `bounds`.
PartitionFindings partition_soup(ooc::Context& context, MeshSource& source, const Lattice& lattice,
                                 const Bounds& bounds, TrianglePartition& partition);

}  // namespace hewer::cluster
