// SPDX-License-Identifier: MIT
/// From clusters and the faces between them to a manifold: sheets that merely touch are taken
/// apart.
#pragma once

#include <cstdint>
#include <vector>

#include "rsimp/block_mesh.h"
#include "rsimp/lost_parts.h"

namespace hewer::rsimp {

/// What is known of the whole surface.
struct SurfaceKind {
    bool is_closed = false;  ///< the input has no border
    bool has_links = false;  ///< as in ClusterMesh
};

struct ManifoldCounts {
    std::uint64_t cancelled_faces = 0;  ///< settled by settle_duplicates()
    std::uint64_t bubble_faces = 0;     ///< of bubbles that folding had pinched off
    std::uint64_t joined_necks = 0;     ///< components that stayed together by join_necks()
    std::uint64_t cut_vertices = 0;     ///< clusters that became more than one vertex
    std::uint64_t lost_cells = 0;       ///< of clusters of which no face is left
    /// These clusters, bar single cells that had no face to begin with: a surface grazed them, and
    /// what stands for it is next to them (find_unseen_cells() has the others).
    std::vector<LostPart> lost;
};

/// Makes vertices of the raw clusters whose faces are all here (kRaw without kFrozen); the others
/// stay as they are and get their turn in a later block. Afterwards every edge at a free vertex has
/// one or two faces, and the faces around it form one fan.
///
///  - Duplicate faces are settled (rsimp/duplicate_faces.h).
///  - An edge with more than two faces is where sheets touch: its faces are paired, forward with
///    backward, the flattest pairs first, and a vertex is made for every fan of faces that is then
///    left around a cluster. So no edge is opened and no edge keeps more than two faces. The fans
///    share the cluster's quadric and step a little apart, towards their own neighbours.
///  - Small closed components that share a cluster with a larger one (bubbles) are dropped, and so
///    are those of two faces, a triangle and its opposite, and small open ones that are copies.
///  - Where links are known, components that a neck held together stay together
///    (rsimp/necks.h). Faces (A, B, B) tell that A and B were neighbours.
///
/// A vertex that cannot be told apart because its neighbour is frozen is frozen too. The order of
/// the faces given does not matter. Memory: about 100 bytes a face on the way.
///
/// `next_fan`: as in add_fan_vertices(); for clusters that were fans themselves once.
ManifoldCounts make_manifold(BlockMesh& mesh, SurfaceKind kind, std::uint64_t* next_fan = nullptr);

}  // namespace hewer::rsimp
