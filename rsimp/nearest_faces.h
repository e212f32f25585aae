// SPDX-License-Identifier: MIT
/// The nearest faces of points that come in batches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ooc/parallel.h"
#include "rsimp/face_tree.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

/// Those of the piece as it is now. Memory: FaceTree, and kBufferBytes.
class NearestFaces {
  public:
    static constexpr std::uint64_t kBufferBytes =
        SampleRuns::kMostPoints * (sizeof(WeightedPoint) + sizeof(FaceTree::Hit));

    NearestFaces(ooc::Workers& workers, const MeshPiece& piece);

    /// A hit for each of the points, of which neighbours should follow one another; until the next
    /// call. Threads that are idle look for their faces, too. Without faces there are no hits.
    std::span<const FaceTree::Hit> find(std::span<const WeightedPoint> points,
                                        double most_distance);

  private:
    ooc::Workers& workers_;
    FaceTree tree_;
    bool is_empty_;
    std::uint32_t guess_ = 0;
    std::vector<FaceTree::Hit> hits_;
};

}  // namespace hewer::rsimp
