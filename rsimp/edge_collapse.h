// SPDX-License-Identifier: MIT
/// Edge collapse in one block, on the quadrics that the clusters carry from the original surface
/// (Garland & Heckbert 1997; Garland & Shaffer 2002).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "ooc/parallel.h"
#include "rsimp/block_mesh.h"
#include "rsimp/edge_quadric.h"
#include "rsimp/indexed_heap.h"
#include "rsimp/part_distance.h"

namespace hewer::rsimp {

/// One collapse: `gone` becomes `kept`, which moves to `position`. Or, without `kept`: the whole
/// component of `gone` vanishes.
struct CollapseStep {
    Vec3 position;
    std::uint32_t kept;  ///< or kNoIndex
    std::uint32_t gone;
    float key;                 ///< the largest cost so far: never falls from step to step
    std::uint16_t n_faces;     ///< that vanish: 2, at a border 1, or those of the component
    std::uint16_t n_vertices;  ///< that vanish: 1, or those of the component
};
static_assert(sizeof(CollapseStep) == 40);

/// What a collapse may do.
struct CollapseRules {
    /// No vertex may end farther than this from any corner of its box, in cells.
    std::optional<double> most_displacement;
    /// Small components that can collapse no further may vanish.
    bool may_vanish = false;
};

/// Where a run of collapses ends; whichever comes first. Counts are from the first run on.
struct CollapseLimit {
    float most_key = std::numeric_limits<float>::infinity();
    std::uint64_t most_faces = std::numeric_limits<std::uint64_t>::max();     ///< that vanish
    std::uint64_t most_vertices = std::numeric_limits<std::uint64_t>::max();  ///< that vanish
};

/// Greedy, cheapest edge first. Every vertex has its cheapest edge to a larger neighbour in a
/// queue, by the quadrics alone; whether an edge can be collapsed, and what a bad shape adds to its
/// cost, is asked when it comes up. Both ends must be free (VertexFlags).
///
/// An edge is collapsed only if that keeps the mesh manifold and its type (link condition), and
/// turns no face by more than 78 degrees. A border stays a border, and an inner vertex that goes
/// into one of its vertices does not move it. Where nothing of a component of up to 16 free
/// vertices can collapse any more, the component as a whole vanishes in its turn if that is allowed
/// (rsimp/vanishing_cost.h), but never the last one of the block.
///
/// The mesh given stays as it is; what was done is in steps(). A run that goes on makes the same
/// steps as one that went through at once. One thread, but for the edges to begin with, which idle
/// threads help to look at. Memory: bytes_for().
class EdgeCollapse {
  public:
    EdgeCollapse(ooc::Workers& workers, const BlockMesh& mesh, const CollapseRules& rules);

    void run(const CollapseLimit& limit);

    [[nodiscard]] const std::vector<CollapseStep>& steps() const { return steps_; }
    /// No edge is left that could be collapsed.
    [[nodiscard]] bool is_finished() const { return queue_.empty(); }

    static constexpr std::uint64_t bytes_for(std::uint64_t n_vertices, std::uint64_t n_faces,
                                             bool has_attribute_quadrics) {
        return n_vertices * (128 + 4 + 8 + 8 + 20 + 40 + PartDistance::kBytesPerVertex +
                             (has_attribute_quadrics ? sizeof(cluster::AttributeQuadric) : 0)) +
               n_faces * (12 + 12);
    }

  private:
    /// A vertex's best edge, as far as known: `cost` is a lower bound until the edge is checked.
    struct Proposal {
        float cost;
        std::uint32_t partner;
    };
    struct Placement {
        Vec3 position;
        double cost;
    };
    /// A neighbourhood is small: gathered into reused vectors.
    struct Scratch {
        std::vector<std::uint32_t> faces_u;
        std::vector<std::uint32_t> faces_v;
        std::vector<std::uint32_t> around_u;  // neighbours: inner ones twice, border ones once
        std::vector<std::uint32_t> around_v;
        std::vector<std::uint32_t> opposite;  // third corners of the faces at the edge
        std::vector<std::uint32_t> larger;
        std::vector<std::uint32_t> faces_w;
        std::vector<std::uint32_t> around_w;
        std::vector<std::pair<double, std::uint32_t>> edges;
        std::vector<std::uint32_t> ring;
        std::vector<std::uint32_t> component;  // vertices
        std::vector<std::uint32_t> component_faces;
    };

    void build_corner_lists();
    void find_borders();
    void prune(std::uint32_t vertex);
    void gather_ring(std::uint32_t vertex, std::vector<std::uint32_t>& faces) const;
    void gather_edge(std::uint32_t u, std::uint32_t v);
    void gather_larger_neighbours(std::uint32_t u, std::vector<std::uint32_t>& larger) const;
    [[nodiscard]] Proposal cheapest(std::uint32_t u, std::vector<std::uint32_t>& larger) const;
    void queue(std::uint32_t u, const Proposal& proposal);
    void propose(std::uint32_t u);
    void review(std::uint32_t u, std::uint32_t moved);
    void check(std::uint32_t u);
    [[nodiscard]] bool is_checked(std::uint32_t u) const {
        return checked_[u] > changed_[u] && checked_[u] > changed_[proposals_[u].partner];
    }
    [[nodiscard]] EdgeQuadric edge_quadric(std::uint32_t u, std::uint32_t v) const;
    [[nodiscard]] std::optional<Placement> place(std::uint32_t u, std::uint32_t v) const;
    [[nodiscard]] bool keeps_type(std::uint32_t v);
    [[nodiscard]] double shape_penalty(std::uint32_t u, std::uint32_t v, const Vec3& x) const;
    void collapse(std::uint32_t u, std::uint32_t v);
    bool gather_component(std::uint32_t u);
    [[nodiscard]] float cost_of_component();
    void vanish(std::uint32_t u);

    CollapseRules rules_;
    std::vector<CollapseVertex> vertices_;
    std::vector<cluster::AttributeQuadric> attributes_;  // empty where they do not count
    std::vector<bool> is_free_;
    std::vector<bool> is_border_;  // right for free vertices
    std::vector<LocalFace> faces_;
    std::vector<std::uint32_t> next_corner_;   // circular list of the corners of each vertex
    std::vector<std::uint32_t> first_corner_;  // any corner of the vertex, kNoIndex if it has none
    std::vector<Proposal> proposals_;
    std::vector<std::uint32_t> changed_;  // when the faces around a vertex changed last
    std::vector<std::uint32_t> checked_;  // when its proposal was found possible
    std::uint32_t clock_ = 0;
    IndexedHeap queue_;
    std::vector<CollapseStep> steps_;
    std::uint64_t n_faces_gone_ = 0;
    std::uint64_t n_vertices_gone_ = 0;
    std::optional<PartDistance> part_distance_;  // from when the first component may vanish
    float key_ = 0;
    Scratch scratch_;
};

}  // namespace hewer::rsimp
