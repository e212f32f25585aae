// SPDX-License-Identifier: MIT
/// A finished mesh of any size on its way out.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "hewer/mesh_sink.h"
#include "hewer/report.h"
#include "hewer/simplify.h"
#include "ooc/context.h"
#include "ooc/result_hash.h"
#include "rsimp/attribute_fit.h"
#include "rsimp/face_normals.h"
#include "rsimp/face_window.h"
#include "rsimp/id_index.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Writes the LODs of one run. Vertices go out in the order of their ids, which is Morton order and
/// so good for fetching them; triangles in that of their smallest vertex, in windows of fixed size
/// that are each in the order a graphics card draws fastest. Sinks that take points get triangles
/// only.
///
/// Passes: two over the vertices, one over the faces, one more of each if a vertex has no normal of
/// its own. Memory: IdIndex, TopologyCounter, kWindowFaceBytes * kWindowFaces (6 MiB) for each
/// window in work, of which there is one more than threads, and 2 MiB for the sink.
class LodOutput {
  public:
    struct Format {
        cluster::Lattice lattice;
        cluster::UniformGrid grid;
        bool has_normals;
        bool has_colors;
        bool has_alpha;
        bool has_double_positions;
        AttributeScales scales{};  ///< of the attribute quadrics
    };

    /// Faces that are ordered together. On an LOD of 4 M triangles .688 vertices a triangle are
    /// transformed with a cache of 16 entries; .686 in windows of 2^16, .681 in one of all faces.
    static constexpr std::uint64_t kWindowFaces = 1 << 15;

    /// With `with_parents`, the ids of the last two LODs are kept, on spools, for parents().
    LodOutput(ooc::Context& context, const Format& format, bool with_parents,
              std::uint64_t window_faces = kWindowFaces);

    /// Fills counts, bounds, error bound and topology of `report`. finish() of the sink is left to
    /// the caller. Throws what the sink and spools throw, Cancelled.
    void write(const MeshStore& mesh, MeshSink& sink, LodReport& report);

    /// Parents of the LOD before the last one in the last one: find_parents() with the merges
    /// between them.
    [[nodiscard]] LodParents parents(std::span<const std::pair<VertexId, VertexId>> merges) const;

    /// Over all that was written: the same whatever the sink takes.
    [[nodiscard]] const ooc::ResultHash& hash() const { return hash_; }

  private:
    struct VertexPiece;
    struct FacePiece;

    [[nodiscard]] Vec3 to_model(const Vec3& origin, const Vec3& position) const;
    IdIndex survey(const MeshStore& mesh, LodReport& report);
    [[nodiscard]] VertexPiece make_vertices(const MeshStore& mesh, std::uint64_t first) const;
    void send_vertices(const MeshStore& mesh, const IdIndex& index, MeshSink& sink);
    [[nodiscard]] FacePiece make_faces(const MeshStore& mesh, const IdIndex& index,
                                       std::uint64_t window, bool with_points) const;
    void send_faces(const MeshStore& mesh, const IdIndex& index, MeshSink& sink, LodReport& report);
    void send_window(const FacePiece& piece, MeshSink& sink);

    ooc::Context& context_;
    Format format_;
    bool with_parents_;
    std::uint64_t window_faces_;
    ooc::Spool<VertexId> before_;  // ids of the LOD before the last one
    ooc::Spool<VertexId> last_;
    ooc::ResultHash hash_;
};

}  // namespace hewer::rsimp
