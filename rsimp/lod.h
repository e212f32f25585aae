// SPDX-License-Identifier: MIT
/// The second half of the pipeline: clusters, finishing collapse, and each LOD on its way out.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cluster/cell_store.h"
#include "hewer/mesh_sink.h"
#include "hewer/report.h"
#include "hewer/simplify.h"
#include "ooc/context.h"
#include "rsimp/edge_collapse.h"
#include "rsimp/refiner.h"
#include "rsimp/stage_log.h"

namespace hewer::rsimp {

/// Writes the LODs of one run, fine to coarse, from a collapse that goes on between them.
class LodWriter {
  public:
    /// What an LOD needs to know of the clusters that the collapse began with.
    struct Origin {
        const cluster::CellStore& store;
        const ooc::Array<std::uint32_t>& cluster_of_cell;
        const ooc::Array<std::uint32_t>& cluster_of_vertex;
        std::uint64_t n_clusters;
        Vec3 frame;  ///< of the collapse's coordinates, in cells
        bool has_normals;
        bool has_colors;
        bool has_alpha;
        bool has_double_positions;
    };

    LodWriter(ooc::Context& context, const Origin& origin, const EdgeCollapse& collapse);

    /// The collapse has been replaced: its vertices are new, and the arrays of Origin refer to new
    /// clusters. `cluster_of_old_vertex`: where the vertices of the old one went, kNoIndex if
    /// nowhere.
    void rebase(const EdgeCollapse& collapse, std::uint64_t n_clusters,
                std::span<const std::uint32_t> cluster_of_old_vertex);

    /// Writes the mesh as it is now; fills the counts, bounds, error bound and topology of
    /// `report`.
    void write(MeshSink& sink, LodReport& report);

    /// Parents of the LOD written before the last one, in the last one's vertex numbers.
    [[nodiscard]] const LodParents& parents() const { return parents_; }
    /// FNV-1a over all that was written, in 64-bit words.
    [[nodiscard]] std::uint64_t hash() const { return hash_; }

  private:
    struct Gathered;
    void measure_displacement(const Gathered& lod, LodReport& report) const;
    void send_vertices(MeshSink& sink, const Gathered& lod);
    void add_to_hash(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3ULL; }

    ooc::Context& context_;
    Origin origin_;
    const EdgeCollapse* collapse_;
    std::vector<std::uint32_t> previous_;  // vertices of the last LOD, in its order
    LodParents parents_;
    std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace hewer::rsimp
