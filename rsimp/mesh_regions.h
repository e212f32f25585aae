// SPDX-License-Identifier: MIT
/// A finished mesh of any size, in pieces with what lies around them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hewer/types.h"
#include "ooc/context.h"
#include "rsimp/id_index.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/mesh_store.h"
#include "rsimp/run_boxes.h"

namespace hewer::rsimp {

/// Regions are the vertices in the largest octree boxes with at most kMostVertices, fewer where the
/// mesh is small, so that several threads have work. Faces stay
/// where they are, in Morton order too: they are known in small runs with the box of each, and a
/// region reads the runs that its box meets. The boxes are those of the positions at the beginning.
/// Nothing here depends on memory or threads.
///
/// Passes to begin with: one over vertices and faces. Memory: IdIndex, some 5 bytes for each
/// hundred faces; while a region is in work region_bytes().
class MeshRegions {
  public:
    /// Own vertices of a region, at most, unless a single box has more.
    static constexpr std::uint64_t kMostVertices = 1 << 14;
    /// A region with more faces around it than this is left as it is.
    static constexpr std::uint64_t kMostFaces = 4 * kMostVertices;

    /// `positions` are those of the mesh. `boxes`, and the first cluster of each and the end, are
    /// those that it was made in.
    MeshRegions(ooc::Context& context, const MeshStore& mesh, const ooc::Spool<Vec3>& positions,
                std::span<const cluster::OctreeBox> boxes,
                std::span<const std::uint64_t> first_cluster);

    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] std::uint64_t first_vertex(std::size_t region) const { return first_[region]; }
    /// The octree boxes of a region, up to first_octree_box(region + 1). Those without a vertex are
    /// in the region after them, or in the last.
    [[nodiscard]] std::size_t first_octree_box(std::size_t region) const {
        return first_octree_box_[region];
    }
    [[nodiscard]] const FloatBox& box(std::size_t region) const { return boxes_[region]; }
    /// More room for a region, within which load() will look for faces.
    void extend(std::size_t region, const FloatBox& box) { boxes_[region].extend(box); }

    /// The faces are others than before, between the same vertices, whose `positions` are those of
    /// the beginning. One pass over them.
    void find_boxes_of_faces(ooc::Context& context, const ooc::Spool<Vec3>& positions);

    /// Memory for any one region with what lies within `reach`, and its tree of faces and sums, and
    /// `more_per_face` for what else is kept.
    [[nodiscard]] std::uint64_t region_bytes(double reach, std::uint64_t more_per_face = 0) const;

    /// A region with its faces and all others within `reach` of its box; `vertices` gets the ranks
    /// of all of its vertices, own ones first, and `own_ids` the ids of these, unless it is null.
    /// No faces if there are more than kMostFaces. Any thread.
    MeshPiece load(std::size_t region, double reach, const ooc::Spool<Vec3>& positions,
                   std::vector<std::uint64_t>& vertices,
                   std::vector<VertexId>* own_ids = nullptr) const;

  private:
    [[nodiscard]] std::uint64_t faces_at_most(std::size_t region, double reach) const;
    void cut(ooc::Context& context, std::span<const cluster::OctreeBox> boxes,
             std::span<const std::uint64_t> first_cluster);

    const MeshStore& mesh_;
    IdIndex index_;
    std::vector<std::uint64_t> first_;  // vertex of each region, and the end
    std::vector<std::size_t> first_octree_box_;
    std::vector<FloatBox> boxes_;  // of regions
    RunBoxes face_boxes_;
};

/// Of all vertices, in the frame of the mesh. One pass.
ooc::Spool<Vec3> positions_of(ooc::Context& context, const MeshStore& mesh);

/// Records at rising places. Any thread.
std::vector<Vec3> read_places(const ooc::Spool<Vec3>& spool, std::span<const std::uint64_t> places);

}  // namespace hewer::rsimp
