// SPDX-License-Identifier: MIT
/// A finished mesh of any size and the samples of its original, in pieces for the fit.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hewer/types.h"
#include "ooc/context.h"
#include "rsimp/fit_moves.h"
#include "rsimp/fit_samples.h"
#include "rsimp/id_index.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Regions are the vertices in the largest octree boxes with at most kMostVertices. Faces and
/// samples stay where they are, in Morton order too: they are known in small runs with the box of
/// each, and a region reads the runs that its box meets. The boxes are those before the fit.
/// Nothing here depends on memory or threads.
///
/// Passes to begin with: one over vertices, faces and samples. Memory: IdIndex, some 10 bytes for
/// each hundred faces or samples; while a region is in work region_bytes().
class FitRegions {
  public:
    /// Own vertices of a region, at most, unless a single box has more.
    static constexpr std::uint64_t kMostVertices = 1 << 14;
    /// A region with more faces around it than this is left as it is.
    static constexpr std::uint64_t kMostFaces = 4 * kMostVertices;

    /// `boxes`, and the first cluster of each and the end, are those that the mesh was made in.
    FitRegions(ooc::Context& context, const MeshStore& mesh, const ooc::Spool<FitSample>& samples,
               std::span<const cluster::OctreeBox> boxes,
               std::span<const std::uint64_t> first_cluster);

    [[nodiscard]] std::size_t size() const { return first_.size() - 1; }
    [[nodiscard]] std::uint64_t first_vertex(std::size_t region) const { return first_[region]; }
    /// Mean distance between neighbouring vertices, in cells: root of the area for each.
    [[nodiscard]] double spacing() const { return spacing_; }

    /// Memory for any one region with what lies within `reach`, and its tree of faces and sums.
    [[nodiscard]] std::uint64_t region_bytes(double reach) const;

    /// A region with its faces and all others within `reach` of its box; `vertices` gets the ranks
    /// of all of its vertices, own ones first. No faces if there are more than kMostFaces. Any
    /// thread.
    FitPiece load(std::size_t region, double reach, const ooc::Spool<Vec3>& positions,
                  std::vector<std::uint64_t>& vertices) const;

    /// Calls visit(points) for the samples within `reach` of the region's box, relative to
    /// `centre`.
    void for_samples(std::size_t region, double reach, const Vec3& centre,
                     const std::function<void(std::span<const WeightedPoint>)>& visit) const;

  private:
    /// In single precision; rounding is monotone, so that a box still holds what went into it.
    struct Box {
        std::array<float, 3> low;
        std::array<float, 3> high;
        void extend(const Vec3& p);
        void extend(const Box& other);
        [[nodiscard]] bool meets(const Box& other, double reach) const;
    };
    static Box empty_box();

    [[nodiscard]] std::uint64_t faces_at_most(std::size_t region, double reach) const;
    void cut(ooc::Context& context, std::span<const cluster::OctreeBox> boxes,
             std::span<const std::uint64_t> first_cluster);
    void find_boxes_of_faces(ooc::Context& context);
    void find_boxes_of_samples(ooc::Context& context);

    const MeshStore& mesh_;
    const ooc::Spool<FitSample>& samples_;
    IdIndex index_;
    std::vector<std::uint64_t> first_;  // vertex of each region, and the end
    std::vector<Box> boxes_;            // of regions
    ooc::Array<Box> face_boxes_;        // of runs of faces
    ooc::Array<Box> sample_boxes_;      // of runs of samples
    std::uint64_t stride_ = 1;          // one of so many samples counts
    double spacing_ = 0;
};

/// Records at rising places. Any thread.
std::vector<Vec3> read_places(const ooc::Spool<Vec3>& spool, std::span<const std::uint64_t> places);

}  // namespace hewer::rsimp
