// SPDX-License-Identifier: MIT
/// The finishing edge collapse: from the refined clusters to the exact target, on the quadrics that
/// the clusters carry from the original surface (Garland & Shaffer 2002), on all workers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cluster/cell_store.h"
#include "cluster/quadric.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "rsimp/cluster_mesh.h"
#include "rsimp/manifold.h"

namespace hewer::rsimp {

/// A manifold mesh on its way down.
struct CollapseMesh {
    ooc::Array<CellTriple> triangles;
    ooc::Array<CollapseVertex> vertices;
    ooc::Array<cluster::CellAttributes> attributes;  ///< summed; may be empty
};

/// Two vertices as one, where the quadrics of both want it, without regard to the faces around
/// them.
struct MergedVertex {
    CollapseVertex vertex;
    double cost = 0;
};
MergedVertex merge(const CollapseVertex& u, const CollapseVertex& v);

/// Where to stop; whichever comes first.
struct CollapseTarget {
    std::uint64_t most_triangles = 0;
    std::uint64_t most_vertices = 0;
    /// No vertex may end farther than this from any corner of its box, in cells.
    std::optional<double> most_displacement;
};

/// Greedy by quadric error, in rounds instead of from a queue. In a round every vertex proposes its
/// best edge; the proposals among the cheapest part of all that are the best within their
/// neighbourhood are carried out at once. They do not touch each other, so the order and the number
/// of threads change nothing. Costs are brought up to date between rounds around what has changed.
///
/// An edge is collapsed only if that keeps the mesh manifold and its type (link condition), and
/// turns no face over. A border stays a border. Memory: 169 bytes a vertex and 24 a triangle, the
/// mesh included.
class EdgeCollapse {
  public:
    EdgeCollapse(ooc::Context& context, CollapseMesh mesh);

    /// Collapses until a target is met or no edge can be collapsed. Targets of later calls must be
    /// smaller. Returns the number of collapses.
    std::uint64_t run(const CollapseTarget& target);

    [[nodiscard]] bool is_met(const CollapseTarget& target) const {
        return n_triangles_ <= target.most_triangles && n_vertices_ <= target.most_vertices;
    }
    /// How many collapses of inner edges the target is away.
    [[nodiscard]] std::uint64_t n_needed(const CollapseTarget& target) const;
    /// The same, if nothing hinders them. 0 with an error bound: nobody knows.
    [[nodiscard]] std::uint64_t n_expected(const CollapseTarget& target) const;

    /// Removes whole closed or open components, smallest box first, until the target is met, when
    /// collapsing can go no further. At least one component stays. Returns how many went.
    std::uint64_t drop_components(const CollapseTarget& target);

    [[nodiscard]] std::uint64_t n_triangles() const { return n_triangles_; }
    [[nodiscard]] std::uint64_t n_vertices() const { return n_vertices_; }

    [[nodiscard]] bool is_live(std::uint32_t vertex) const { return parent_[vertex] == vertex; }
    /// The live vertex that stands for `vertex` now; kNoIndex if its component was dropped.
    [[nodiscard]] std::uint32_t representative(std::uint32_t vertex) const;
    [[nodiscard]] const CollapseMesh& mesh() const { return mesh_; }
    [[nodiscard]] bool is_live_triangle(std::uint64_t t) const {
        return mesh_.triangles[t][0] != kNoIndex;
    }

  private:
    /// A vertex's best edge, as far as known: `cost` is a lower bound until the edge is checked.
    struct Proposal {
        float cost;
        std::uint32_t partner;
    };
    /// A neighbourhood is small: gathered into reused vectors.
    struct Scratch;

    struct Placement {
        Vec3 position;
        double cost;
    };

    void build_corner_lists();
    void prune(std::uint32_t vertex);
    void gather_ring(std::uint32_t vertex, std::vector<std::uint32_t>& faces) const;
    void gather_edge(std::uint32_t u, std::uint32_t v, Scratch& scratch) const;
    void gather_larger_neighbours(std::uint32_t u, Scratch& scratch) const;
    void propose(std::uint32_t u, Scratch& scratch);
    void review(std::uint32_t u, Scratch& scratch);
    void check(std::uint32_t u, Scratch& scratch);
    [[nodiscard]] bool is_checked(std::uint32_t u) const {
        return checked_[u] > changed_[u] && checked_[u] > changed_[proposals_[u].partner];
    }
    [[nodiscard]] std::optional<Placement> place(std::uint32_t u, std::uint32_t v,
                                                 const Scratch& scratch) const;
    [[nodiscard]] bool keeps_type(std::uint32_t v, Scratch& scratch) const;
    [[nodiscard]] double shape_penalty(std::uint32_t u, std::uint32_t v, const Vec3& x,
                                       const Scratch& scratch) const;
    void collapse(std::uint32_t u, std::uint32_t v, Scratch& scratch);
    void refresh_proposals();
    [[nodiscard]] std::uint64_t cost_bound(std::uint64_t needed) const;
    void claim_neighbourhoods(std::uint64_t bound);
    [[nodiscard]] std::vector<std::uint64_t> find_winners(std::uint64_t bound) const;
    std::uint64_t carry_out(const std::vector<std::uint64_t>& winners, std::uint64_t most);
    std::uint64_t round(const CollapseTarget& target);

    ooc::Context& context_;
    CollapseMesh mesh_;
    std::uint64_t n_triangles_ = 0;
    std::uint64_t n_vertices_ = 0;
    std::optional<double> most_displacement_;
    std::uint32_t round_ = 0;
    ooc::Array<std::uint32_t> next_corner_;   // circular list of the corners of each vertex
    ooc::Array<std::uint32_t> first_corner_;  // any corner of the vertex
    ooc::Array<std::uint32_t> parent_;        // itself while live
    ooc::Array<Proposal> proposals_;
    ooc::Array<std::uint64_t> claims_;
    ooc::Array<std::uint32_t> changed_;  // round in which the faces around a vertex changed last
    ooc::Array<std::uint32_t> checked_;  // round in which its proposal was found possible
    ooc::Array<std::uint8_t> marks_;     // kStale, kReview, kTouched, kMoved
    ooc::Array<std::uint32_t> live_;
    std::uint64_t n_live_ = 0;
};

}  // namespace hewer::rsimp
