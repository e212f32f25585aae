// SPDX-License-Identifier: MIT
/// A finished mesh on its way out.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"
#include "hewer/mesh_sink.h"
#include "hewer/report.h"
#include "hewer/simplify.h"
#include "ooc/context.h"
#include "rsimp/mesh_store.h"

namespace hewer::rsimp {

/// Writes the LODs of one run. Vertices go out in the order of their ids, which is Morton order;
/// triangles in that of their smallest vertex, in windows of fixed size that are each in the order
/// a graphics card draws fastest. Memory: VertexRank, count_topology(), and for each window at work
/// 6 MiB.
class LodOutput {
  public:
    struct Format {
        cluster::Lattice lattice;
        cluster::UniformGrid grid;
        bool has_normals;
        bool has_colors;
        bool has_alpha;
        bool has_double_positions;
    };

    /// With `with_parents`, 8 bytes a vertex of the last two LODs are held for parents().
    LodOutput(ooc::Context& context, const Format& format, bool with_parents);

    /// Fills counts, bounds, error bound and topology of `report`.
    void write(const MeshStore& mesh, MeshSink& sink, LodReport& report);

    /// Parents of the LOD before the last one in the last one, from the merges between them, in
    /// order.
    [[nodiscard]] LodParents parents(
        const std::vector<std::pair<VertexId, VertexId>>& merges) const;

    /// FNV-1a over all that was written, in 64-bit words.
    [[nodiscard]] std::uint64_t hash() const { return hash_; }

  private:
    using IndexFace = std::array<std::uint32_t, 3>;

    [[nodiscard]] Vec3 to_model(const Vec3& origin, const Vec3& position) const;
    void survey(const MeshStore& mesh, LodReport& report) const;
    ooc::Spool<IndexFace> index_faces(const MeshStore& mesh) const;
    void send_vertices(const MeshStore& mesh, const ooc::Spool<IndexFace>& faces, MeshSink& sink);
    void send_triangles(const ooc::Spool<IndexFace>& faces, MeshSink& sink);
    void add_to_hash(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3ULL; }

    ooc::Context& context_;
    Format format_;
    bool with_parents_;
    std::vector<VertexId> before_;  // ids of the LOD before the last one
    std::vector<VertexId> last_;
    std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace hewer::rsimp
