// SPDX-License-Identifier: MIT
#include "rsimp/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/edge_quadric.h"
#include "rsimp/vanishing_cost.h"

namespace hewer::rsimp {

namespace {

constexpr float kNoCost = std::numeric_limits<float>::infinity();
// A face may turn by at most acos(0.2), 78 degrees, in one collapse.
constexpr double kLeastCosine = 0.2;
// Below this quality (1: equilateral) the cost is raised in proportion.
constexpr double kPoorShape = 0.15;
// Vertices of a component that may vanish at once.
constexpr std::size_t kMostVanishing = 16;

void gather_neighbours(const std::vector<LocalFace>& triangles,
                       const std::vector<std::uint32_t>& faces, std::uint32_t vertex,
                       std::vector<std::uint32_t>& around) {
    around.clear();
    for (const std::uint32_t f : faces) {
        for (const std::uint32_t w : triangles[f]) {
            if (w != vertex) around.push_back(w);
        }
    }
}

bool has_single(const std::vector<std::uint32_t>& around) {
    return std::any_of(around.begin(), around.end(), [&](std::uint32_t w) {
        return std::count(around.begin(), around.end(), w) == 1;
    });
}

bool contains(const LocalFace& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
}

}  // namespace

EdgeCollapse::EdgeCollapse(ooc::Workers& workers, const BlockMesh& mesh, const CollapseRules& rules)
    : rules_(rules),
      attributes_(mesh.attributes.quadrics),
      is_free_(mesh.vertices.size()),
      is_border_(mesh.vertices.size()),
      faces_(mesh.faces),
      next_corner_(3 * mesh.faces.size()),
      first_corner_(mesh.vertices.size(), kNoIndex),
      proposals_(mesh.vertices.size(), {kNoCost, kNoIndex}),
      changed_(mesh.vertices.size()),
      checked_(mesh.vertices.size()),
      queue_(mesh.vertices.size()) {
    vertices_.reserve(mesh.vertices.size());
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        vertices_.push_back(mesh.vertices[v].vertex);
        is_free_[v] = mesh.is_free(v);
    }
    build_corner_lists();
    find_borders();
    constexpr std::size_t kVerticesPerPiece = 512;
    workers.for_ranges(vertices_.size(), kVerticesPerPiece, [&](std::size_t b, std::size_t e) {
        std::vector<std::uint32_t> larger;
        for (std::size_t v = b; v < e; ++v) {
            const auto u = static_cast<std::uint32_t>(v);
            if (is_free_[u]) proposals_[u] = cheapest(u, larger);
        }
    });
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) queue(v, proposals_[v]);
}

void EdgeCollapse::build_corner_lists() {
    for (std::uint32_t t = 0; t < faces_.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t corner = 3 * t + i;
            std::uint32_t& first = first_corner_[faces_[t][i]];
            if (first == kNoIndex) {
                first = next_corner_[corner] = corner;
            } else {
                next_corner_[corner] = std::exchange(next_corner_[first], corner);
            }
        }
    }
}

/// Around an inner vertex each neighbour is in two faces; of a fan with two ends, these are in one.
void EdgeCollapse::find_borders() {
    std::vector<std::uint32_t> odd(vertices_.size());
    for (const LocalFace& t : faces_) {
        for (const std::uint32_t v : t) odd[v] ^= t[0] ^ t[1] ^ t[2] ^ v;
    }
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) is_border_[v] = odd[v] != 0;
}

/// Takes the dead faces out of the list of a vertex.
void EdgeCollapse::prune(std::uint32_t vertex) {
    const auto is_live = [&](std::uint32_t face) { return faces_[face][0] != kNoIndex; };
    const std::uint32_t start = first_corner_[vertex];
    std::uint32_t previous = start;
    std::uint32_t corner = next_corner_[start];
    // The start goes last, when it is known whether anything else is left.
    while (corner != start) {
        if (is_live(corner / 3)) {
            previous = corner;
        } else {
            next_corner_[previous] = next_corner_[corner];
        }
        corner = next_corner_[corner];
    }
    if (!is_live(start / 3)) {
        next_corner_[previous] = next_corner_[start];
        first_corner_[vertex] = previous;
    }
}

void EdgeCollapse::gather_ring(std::uint32_t vertex, std::vector<std::uint32_t>& faces) const {
    faces.clear();
    const std::uint32_t start = first_corner_[vertex];
    std::uint32_t corner = start;
    do {
        faces.push_back(corner / 3);
        corner = next_corner_[corner];
    } while (corner != start);
}

bool EdgeCollapse::keeps_type(std::uint32_t v) {
    Scratch& s = scratch_;
    if (s.opposite.empty() || s.opposite.size() > 2) return false;
    // A flap that hangs on a vertex that is not free would vanish.
    if (s.faces_u.size() + s.faces_v.size() == 2 * s.opposite.size()) return false;
    // Link condition: the only neighbours in common are the third corners of the faces at the edge.
    std::size_t n_common = 0;
    for (std::size_t i = 0; i < s.around_u.size(); ++i) {
        const std::uint32_t w = s.around_u[i];
        if (w == v || std::find(s.around_v.begin(), s.around_v.end(), w) == s.around_v.end())
            continue;
        const auto seen = s.around_u.begin() + static_cast<std::ptrdiff_t>(i);
        if (std::find(s.around_u.begin(), seen, w) == seen) ++n_common;
    }
    if (n_common != s.opposite.size()) return false;
    // Two border vertices joined by an inner edge: the surface would be pinched.
    if (s.opposite.size() == 2 && has_single(s.around_u) && has_single(s.around_v)) return false;
    // The third corners lose a face: what is left around them must still be a fan.
    for (const std::uint32_t w : s.opposite) {
        gather_ring(w, s.faces_w);
        if (s.faces_w.size() >= 4) continue;
        // Of a vertex that is not free some faces may be elsewhere.
        if (!is_free_[w]) return false;
        gather_neighbours(faces_, s.faces_w, w, s.around_w);
        if (s.faces_w.size() < (has_single(s.around_w) ? 2U : 4U)) return false;
    }
    return true;
}

double EdgeCollapse::shape_penalty(std::uint32_t u, std::uint32_t v, const Vec3& x) const {
    const Scratch& s = scratch_;
    double worst = 1;
    const auto check = [&](const std::vector<std::uint32_t>& faces, std::uint32_t moved,
                           std::uint32_t other) {
        for (const std::uint32_t f : faces) {
            const LocalFace& t = faces_[f];
            if (contains(t, other)) continue;
            const std::size_t i = t[0] == moved ? 0 : (t[1] == moved ? 1 : 2);
            const Vec3& a = vertices_[t[(i + 1) % 3]].position;
            const Vec3& b = vertices_[t[(i + 2) % 3]].position;
            const Vec3 ab = b - a;
            const Vec3 before = cross(ab, vertices_[moved].position - a);
            const Vec3 xa = x - a;
            const Vec3 after = cross(ab, xa);
            const double length_before = std::sqrt(dot(before, before));
            const double length_after = std::sqrt(dot(after, after));
            if (dot(before, after) < kLeastCosine * length_before * length_after) return false;
            const Vec3 xb = x - b;
            const double sum = dot(ab, ab) + dot(xa, xa) + dot(xb, xb);
            constexpr double kEquilateral = 3.4641016151377544;  // 2 sqrt(3)
            worst = std::min(worst, kEquilateral * length_after / std::max(sum, 1e-300));
        }
        return true;
    };
    if (!check(s.faces_u, u, v) || !check(s.faces_v, v, u)) {
        return std::numeric_limits<double>::infinity();
    }
    return worst < kPoorShape ? kPoorShape / std::max(worst, 1e-3) : 1;
}

EdgeQuadric EdgeCollapse::edge_quadric(std::uint32_t u, std::uint32_t v) const {
    EdgeQuadric edge = attributes_.empty() ? EdgeQuadric(vertices_[u], vertices_[v])
                                           : EdgeQuadric(vertices_[u], vertices_[v], attributes_[u],
                                                         attributes_[v]);
    if (is_border_[u] != is_border_[v]) edge.optimum = vertices_[is_border_[u] ? u : v].position;
    return edge;
}

std::optional<EdgeCollapse::Placement> EdgeCollapse::place(std::uint32_t u, std::uint32_t v) const {
    const EdgeQuadric edge = edge_quadric(u, v);
    const Vec3& pu = vertices_[u].position;
    const Vec3& pv = vertices_[v].position;
    std::optional<Placement> best;
    const auto consider = [&](const Vec3& x) {
        if (rules_.most_displacement &&
            farthest_corner(edge.low, edge.high, x) > *rules_.most_displacement) {
            return;
        }
        const double cost = edge.cost(x);
        if (best && cost >= best->cost) return;
        const double penalized = cost * shape_penalty(u, v, x);
        if (std::isfinite(penalized) && (!best || penalized < best->cost)) best = {x, penalized};
    };
    consider(edge.optimum);
    if (!best && is_border_[u] == is_border_[v]) {
        consider(0.5 * (pu + pv));
        consider(pu);
        consider(pv);
    }
    return best;
}

void EdgeCollapse::gather_edge(std::uint32_t u, std::uint32_t v) {
    Scratch& s = scratch_;
    gather_ring(u, s.faces_u);
    gather_ring(v, s.faces_v);
    gather_neighbours(faces_, s.faces_u, u, s.around_u);
    gather_neighbours(faces_, s.faces_v, v, s.around_v);
    s.opposite.clear();
    for (const std::uint32_t f : s.faces_u) {
        const LocalFace& t = faces_[f];
        if (contains(t, v)) s.opposite.push_back(t[0] ^ t[1] ^ t[2] ^ u ^ v);
    }
}

/// Each once, and only free ones: an edge is proposed by its smaller vertex.
void EdgeCollapse::gather_larger_neighbours(std::uint32_t u,
                                            std::vector<std::uint32_t>& larger) const {
    larger.clear();
    const std::uint32_t start = first_corner_[u];
    if (start == kNoIndex) return;
    std::uint32_t corner = start;
    do {
        for (const std::uint32_t v : faces_[corner / 3]) {
            if (v > u && is_free_[v] &&
                std::find(larger.begin(), larger.end(), v) == larger.end()) {
                larger.push_back(v);
            }
        }
        corner = next_corner_[corner];
    } while (corner != start);
}

void EdgeCollapse::queue(std::uint32_t u, const Proposal& proposal) {
    proposals_[u] = proposal;
    if (proposal.cost == kNoCost) {
        queue_.erase(u);
    } else {
        queue_.set(u, proposal.cost);
    }
}

/// The cheapest edge to a larger neighbour, by the quadric alone. Most proposals never come up, so
/// whether the edge can be collapsed is asked only when one does.
EdgeCollapse::Proposal EdgeCollapse::cheapest(std::uint32_t u,
                                              std::vector<std::uint32_t>& larger) const {
    Proposal best{kNoCost, kNoIndex};
    gather_larger_neighbours(u, larger);
    for (const std::uint32_t v : larger) {
        const EdgeQuadric edge = edge_quadric(u, v);
        const auto cost = static_cast<float>(edge.cost(edge.optimum));
        if (cost < best.cost || (cost == best.cost && v < best.partner)) best = {cost, v};
    }
    return best;
}

void EdgeCollapse::propose(std::uint32_t u) {
    checked_[u] = 0;
    queue(u, cheapest(u, scratch_.larger));
}

/// Only the edge to the neighbour that has moved can have become better than the one proposed.
void EdgeCollapse::review(std::uint32_t u, std::uint32_t moved) {
    if (moved < u) return;
    const EdgeQuadric edge = edge_quadric(u, moved);
    const auto cost = static_cast<float>(edge.cost(edge.optimum));
    const Proposal& old = proposals_[u];
    if (cost < old.cost || (cost == old.cost && moved < old.partner)) {
        checked_[u] = 0;
        queue(u, {cost, moved});
    }
}

/// Makes the proposal one that can be carried out: of all edges to larger neighbours the cheapest,
/// with penalties, whose collapse is possible.
void EdgeCollapse::check(std::uint32_t u) {
    Scratch& s = scratch_;
    Proposal best{kNoCost, kNoIndex};
    gather_larger_neighbours(u, s.larger);
    s.edges.clear();
    for (const std::uint32_t v : s.larger) {
        const EdgeQuadric edge = edge_quadric(u, v);
        s.edges.emplace_back(edge.cost(edge.optimum), v);
    }
    std::sort(s.edges.begin(), s.edges.end());
    for (const auto& [cost, v] : s.edges) {
        if (cost >= static_cast<double>(best.cost)) break;  // penalties only raise costs
        gather_edge(u, v);
        if (!keeps_type(v)) continue;
        const auto placement = place(u, v);
        if (placement && placement->cost < static_cast<double>(best.cost)) {
            best = {static_cast<float>(placement->cost), v};
        }
    }
    if (best.partner == kNoIndex && rules_.may_vanish && gather_component(u)) {
        best = {cost_of_component(), u};
    }
    checked_[u] = ++clock_;
    queue(u, best);
}

/// The component of u may vanish: u is its first vertex, all of them are free, they are few, and
/// there is more in the block than this component.
bool EdgeCollapse::gather_component(std::uint32_t u) {
    Scratch& s = scratch_;
    s.component.assign(1, u);
    s.component_faces.clear();
    for (std::size_t i = 0; i < s.component.size(); ++i) {
        gather_ring(s.component[i], s.ring);
        for (const std::uint32_t f : s.ring) {
            const LocalFace& t = faces_[f];
            if (t[0] == s.component[i]) s.component_faces.push_back(f);
            for (const std::uint32_t w : t) {
                if (w < u || !is_free_[w]) return false;
                if (std::find(s.component.begin(), s.component.end(), w) == s.component.end()) {
                    if (s.component.size() == kMostVanishing) return false;
                    s.component.push_back(w);
                }
            }
        }
    }
    return n_faces_gone_ + s.component_faces.size() < faces_.size();
}

/// For each two faces, as all costs are.
float EdgeCollapse::cost_of_component() {
    if (!part_distance_) part_distance_.emplace(vertices_, faces_);
    const Scratch& s = scratch_;
    const std::uint32_t first = s.component.front();
    const double distance_sq = part_distance_->squared(first, vertices_[first].position);
    const double cost =
        vanishing_cost(vertices_, faces_, s.component, s.component_faces, distance_sq);
    return static_cast<float>(2 * cost / static_cast<double>(s.component_faces.size()));
}

void EdgeCollapse::vanish(std::uint32_t u) {
    Scratch& s = scratch_;
    if (!gather_component(u)) {  // by now it is the last
        queue_.erase(u);
        return;
    }
    for (const std::uint32_t f : s.component_faces) faces_[f] = {kNoIndex, kNoIndex, kNoIndex};
    for (const std::uint32_t v : s.component) queue_.erase(v);
    n_faces_gone_ += s.component_faces.size();
    n_vertices_gone_ += s.component.size();
    steps_.push_back({vertices_[u].position, kNoIndex, u, key_,
                      static_cast<std::uint16_t>(s.component_faces.size()),
                      static_cast<std::uint16_t>(s.component.size())});
}

void EdgeCollapse::collapse(std::uint32_t u, std::uint32_t v) {
    Scratch& s = scratch_;
    gather_edge(u, v);
    const Vec3 position = place(u, v)->position;
    CollapseVertex& kept = vertices_[u];
    const CollapseVertex& gone = vertices_[v];
    kept.quadric += gone.quadric;
    if (!attributes_.empty()) attributes_[u] += attributes_[v];
    widen(kept.box, gone.box);
    kept.position = position;
    is_border_[u] = is_border_[u] || is_border_[v];
    for (const std::uint32_t f : s.faces_v) {
        LocalFace& t = faces_[f];
        if (contains(t, u)) {
            t = {kNoIndex, kNoIndex, kNoIndex};
        } else {
            for (std::uint32_t& w : t) {
                if (w == v) w = u;
            }
        }
    }
    // Two circular lists become one by exchanging the successors of one corner of each.
    std::swap(next_corner_[first_corner_[u]], next_corner_[first_corner_[v]]);
    prune(u);
    for (const std::uint32_t w : s.opposite) prune(w);
    queue_.erase(v);
    n_faces_gone_ += s.opposite.size();
    ++n_vertices_gone_;
    steps_.push_back({position, u, v, key_, static_cast<std::uint16_t>(s.opposite.size()), 1});

    changed_[u] = ++clock_;
    s.ring.clear();
    for (const auto* around : {&s.around_u, &s.around_v}) {
        for (const std::uint32_t w : *around) {
            if (w == u || w == v || changed_[w] == clock_) continue;
            changed_[w] = clock_;
            if (is_free_[w]) s.ring.push_back(w);
        }
    }
    propose(u);
    for (const std::uint32_t w : s.ring) {
        const Proposal& p = proposals_[w];
        if (p.partner == u || p.partner == v || p.cost == kNoCost) {
            propose(w);
        } else {
            review(w, u);
        }
    }
}

void EdgeCollapse::run(const CollapseLimit& limit) {
    while (!queue_.empty() && n_faces_gone_ < limit.most_faces &&
           n_vertices_gone_ < limit.most_vertices) {
        const std::uint32_t u = queue_.top();
        const float cost = queue_.top_key();
        if (std::max(cost, key_) > limit.most_key) break;
        if (!is_checked(u)) {
            check(u);
            continue;
        }
        key_ = std::max(key_, cost);
        const std::uint32_t v = proposals_[u].partner;
        if (v == u) {
            vanish(u);
        } else {
            collapse(u, v);
        }
    }
}

}  // namespace hewer::rsimp
