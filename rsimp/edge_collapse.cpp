// SPDX-License-Identifier: MIT
#include "rsimp/edge_collapse.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/edge_quadric.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint8_t kStale = 1;    // the proposal must be made anew
constexpr std::uint8_t kReview = 2;   // a neighbour has moved: its edge may be better now
constexpr std::uint8_t kTouched = 4;  // the corner list may hold dead faces
constexpr std::uint8_t kMoved = 8;    // merged in the last round
constexpr float kNoCost = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kGrain = 2048;

// The cheapest part of all proposals that a round may carry out: small enough to stay close to the
// greedy order, large enough to be done in a few dozen rounds.
constexpr double kRoundShare = 0.25;
constexpr double kLeastRoundShare = 0.01;
// About one proposal in three is the best of its neighbourhood.
constexpr double kProposalsPerCollapse = 3;

// Rounds without a collapse after which the mesh counts as finished.
constexpr int kMostIdleRounds = 8;

// A face may turn by at most acos(0.2), 78 degrees, in one collapse.
constexpr double kLeastCosine = 0.2;
// Below this quality (1: equilateral) the cost is raised in proportion.
constexpr double kPoorShape = 0.15;

void mark(std::uint8_t& marks, std::uint8_t bits) {
    std::atomic_ref<std::uint8_t>(marks).fetch_or(bits, std::memory_order_relaxed);
}

/// Smaller is better; unique, since a vertex makes one proposal.
std::uint64_t claim_key(float cost, std::uint32_t vertex) {
    return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(cost)) << 32 | vertex;
}

void claim(std::uint64_t& slot, std::uint64_t key) {
    std::atomic_ref<std::uint64_t> current(slot);
    std::uint64_t old = current.load(std::memory_order_relaxed);
    while (key < old && !current.compare_exchange_weak(old, key, std::memory_order_relaxed)) {
    }
}

}  // namespace

struct EdgeCollapse::Scratch {
    std::vector<std::uint32_t> faces_u;
    std::vector<std::uint32_t> faces_v;
    std::vector<std::uint32_t> around_u;  // neighbours: inner ones twice, border ones once
    std::vector<std::uint32_t> around_v;
    std::vector<std::uint32_t> opposite;  // third corners of the faces at the edge
    std::vector<std::uint32_t> larger;
    std::vector<std::uint32_t> faces_w;
    std::vector<std::uint32_t> around_w;
    std::vector<std::pair<double, std::uint32_t>> edges;
};

EdgeCollapse::EdgeCollapse(ooc::Context& context, CollapseMesh mesh)
    : context_(context),
      mesh_(std::move(mesh)),
      n_triangles_(mesh_.triangles.size()),
      n_vertices_(mesh_.vertices.size()),
      next_corner_(context.budget(), "corner lists", 3 * n_triangles_),
      first_corner_(context.budget(), "corner lists", n_vertices_),
      parent_(context.budget(), "collapse parents", n_vertices_),
      proposals_(context.budget(), "proposals", n_vertices_),
      claims_(context.budget(), "claims", n_vertices_),
      changed_(context.budget(), "rounds", n_vertices_),
      checked_(context.budget(), "rounds", n_vertices_),
      marks_(context.budget(), "marks", n_vertices_),
      live_(context.budget(), "live vertices", n_vertices_),
      n_live_(n_vertices_) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::iota(live_.begin(), live_.end(), 0U);
    std::fill(marks_.begin(), marks_.end(), kStale);
    build_corner_lists();
}

void EdgeCollapse::build_corner_lists() {
    std::fill(first_corner_.begin(), first_corner_.end(), kNoIndex);
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t corner = 3 * t + i;
            std::uint32_t& first = first_corner_[mesh_.triangles[t][i]];
            if (first == kNoIndex) {
                first = next_corner_[corner] = corner;
            } else {
                next_corner_[corner] = std::exchange(next_corner_[first], corner);
            }
        }
    }
}

void EdgeCollapse::prune(std::uint32_t vertex) {
    const std::uint32_t start = first_corner_[vertex];
    std::uint32_t previous = start;
    std::uint32_t corner = next_corner_[start];
    // The start goes last, when it is known whether anything else is left.
    while (corner != start) {
        if (is_live_triangle(corner / 3)) {
            previous = corner;
        } else {
            next_corner_[previous] = next_corner_[corner];
        }
        corner = next_corner_[corner];
    }
    if (!is_live_triangle(start / 3)) {
        next_corner_[previous] = next_corner_[start];
        first_corner_[vertex] = previous;
    }
}

void EdgeCollapse::gather_ring(std::uint32_t vertex, std::vector<std::uint32_t>& faces) const {
    faces.clear();
    const std::uint32_t start = first_corner_[vertex];
    std::uint32_t corner = start;
    do {
        if (is_live_triangle(corner / 3)) faces.push_back(corner / 3);
        corner = next_corner_[corner];
    } while (corner != start);
}

std::uint32_t EdgeCollapse::representative(std::uint32_t vertex) const {
    while (parent_[vertex] != vertex) {
        vertex = parent_[vertex];
        if (vertex == kNoIndex) return kNoIndex;
    }
    return vertex;
}

namespace {

void gather_neighbours(const ooc::Array<CellTriple>& triangles,
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

bool contains(const CellTriple& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
}

}  // namespace

bool EdgeCollapse::keeps_type(std::uint32_t v, Scratch& s) const {
    if (s.opposite.empty() || s.opposite.size() > 2) return false;
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
        gather_neighbours(mesh_.triangles, s.faces_w, w, s.around_w);
        if (s.faces_w.size() < (has_single(s.around_w) ? 2U : 4U)) return false;
    }
    return true;
}

double EdgeCollapse::shape_penalty(std::uint32_t u, std::uint32_t v, const Vec3& x,
                                   const Scratch& s) const {
    double worst = 1;
    const auto check = [&](const std::vector<std::uint32_t>& faces, std::uint32_t moved,
                           std::uint32_t other) {
        for (const std::uint32_t f : faces) {
            const CellTriple& t = mesh_.triangles[f];
            if (contains(t, other)) continue;
            const std::size_t i = t[0] == moved ? 0 : (t[1] == moved ? 1 : 2);
            const Vec3& a = mesh_.vertices[t[(i + 1) % 3]].position;
            const Vec3& b = mesh_.vertices[t[(i + 2) % 3]].position;
            const Vec3 ab = b - a;
            const Vec3 before = cross(ab, mesh_.vertices[moved].position - a);
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

std::optional<EdgeCollapse::Placement> EdgeCollapse::place(std::uint32_t u, std::uint32_t v,
                                                           const Scratch& scratch) const {
    const EdgeQuadric edge(mesh_.vertices[u], mesh_.vertices[v]);
    const Vec3& pu = mesh_.vertices[u].position;
    const Vec3& pv = mesh_.vertices[v].position;
    std::optional<Placement> best;
    const auto consider = [&](const Vec3& x) {
        if (most_displacement_ && farthest_corner(edge.low, edge.high, x) > *most_displacement_) {
            return;
        }
        const double cost = edge.cost(x);
        if (best && cost >= best->cost) return;
        const double penalized = cost * shape_penalty(u, v, x, scratch);
        if (std::isfinite(penalized) && (!best || penalized < best->cost)) best = {x, penalized};
    };
    consider(edge.optimum);
    if (!best) {
        consider(0.5 * (pu + pv));
        consider(pu);
        consider(pv);
    }
    return best;
}

void EdgeCollapse::gather_edge(std::uint32_t u, std::uint32_t v, Scratch& s) const {
    gather_ring(u, s.faces_u);
    gather_ring(v, s.faces_v);
    gather_neighbours(mesh_.triangles, s.faces_u, u, s.around_u);
    gather_neighbours(mesh_.triangles, s.faces_v, v, s.around_v);
    s.opposite.clear();
    for (const std::uint32_t f : s.faces_u) {
        const CellTriple& t = mesh_.triangles[f];
        if (contains(t, v)) s.opposite.push_back(t[0] ^ t[1] ^ t[2] ^ u ^ v);
    }
}

/// Each once: an edge is proposed by its smaller vertex.
void EdgeCollapse::gather_larger_neighbours(std::uint32_t u, Scratch& s) const {
    s.larger.clear();
    std::uint32_t corner = first_corner_[u];
    const std::uint32_t start = corner;
    do {
        const CellTriple& t = mesh_.triangles[corner / 3];
        for (const std::uint32_t v : t) {
            if (v > u && v != kNoIndex &&
                std::find(s.larger.begin(), s.larger.end(), v) == s.larger.end()) {
                s.larger.push_back(v);
            }
        }
        corner = next_corner_[corner];
    } while (corner != start);
}

/// The cheapest edge to a larger neighbour, by the quadric alone. Most proposals never come up, so
/// whether the edge can be collapsed is asked only when one does.
void EdgeCollapse::propose(std::uint32_t u, Scratch& s) {
    Proposal best{kNoCost, kNoIndex};
    gather_larger_neighbours(u, s);
    for (const std::uint32_t v : s.larger) {
        const EdgeQuadric edge(mesh_.vertices[u], mesh_.vertices[v]);
        const auto cost = static_cast<float>(edge.cost(edge.optimum));
        if (cost < best.cost || (cost == best.cost && v < best.partner)) best = {cost, v};
    }
    proposals_[u] = best;
    checked_[u] = 0;
}

/// Only edges to neighbours that have moved can have become better than the one proposed.
void EdgeCollapse::review(std::uint32_t u, Scratch& s) {
    Proposal best = proposals_[u];
    gather_larger_neighbours(u, s);
    for (const std::uint32_t v : s.larger) {
        if ((marks_[v] & kMoved) == 0) continue;
        const EdgeQuadric edge(mesh_.vertices[u], mesh_.vertices[v]);
        const auto cost = static_cast<float>(edge.cost(edge.optimum));
        if (cost < best.cost || (cost == best.cost && v < best.partner)) {
            best = {cost, v};
            checked_[u] = 0;
        }
    }
    proposals_[u] = best;
}

/// Makes the proposal one that can be carried out: of all edges to larger neighbours the cheapest,
/// with penalties, whose collapse is possible.
void EdgeCollapse::check(std::uint32_t u, Scratch& s) {
    Proposal best{kNoCost, kNoIndex};
    gather_larger_neighbours(u, s);
    s.edges.clear();
    for (const std::uint32_t v : s.larger) {
        const EdgeQuadric edge(mesh_.vertices[u], mesh_.vertices[v]);
        s.edges.emplace_back(edge.cost(edge.optimum), v);
    }
    std::sort(s.edges.begin(), s.edges.end());
    for (const auto& [cost, v] : s.edges) {
        if (cost >= static_cast<double>(best.cost)) break;  // penalties only raise costs
        gather_edge(u, v, s);
        if (!keeps_type(v, s)) continue;
        const auto placement = place(u, v, s);
        if (placement && placement->cost < static_cast<double>(best.cost)) {
            best = {static_cast<float>(placement->cost), v};
        }
    }
    proposals_[u] = best;
    checked_[u] = round_;
}

void EdgeCollapse::collapse(std::uint32_t u, std::uint32_t v, Scratch& s) {
    const auto placement = place(u, v, s);
    CollapseVertex& kept = mesh_.vertices[u];
    const CollapseVertex& gone = mesh_.vertices[v];
    kept.quadric += gone.quadric;
    for (std::size_t i = 0; i < 3; ++i) {
        kept.box[i] = std::min(kept.box[i], gone.box[i]);
        kept.box[3 + i] = std::max(kept.box[3 + i], gone.box[3 + i]);
    }
    kept.position = placement->position;
    if (!mesh_.attributes.empty()) mesh_.attributes[u] += mesh_.attributes[v];
    for (const std::uint32_t f : s.faces_v) {
        CellTriple& t = mesh_.triangles[f];
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
    parent_[v] = u;
    mark(marks_[u], kStale | kTouched | kMoved);
    const auto change = [&](std::uint32_t w) {
        std::atomic_ref<std::uint32_t>(changed_[w]).store(round_, std::memory_order_relaxed);
    };
    change(u);
    for (const auto* around : {&s.around_u, &s.around_v}) {
        for (const std::uint32_t w : *around) {
            if (w == u || w == v) continue;
            const Proposal& p = proposals_[w];
            const bool is_lost = p.partner == u || p.partner == v || p.cost == kNoCost;
            mark(marks_[w], kTouched | (is_lost ? kStale : kReview));
            change(w);
        }
    }
}

void EdgeCollapse::refresh_proposals() {
    context_.workers().for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            if ((marks_[u] & kTouched) != 0) prune(u);
            claims_[u] = std::numeric_limits<std::uint64_t>::max();
        }
    });
    context_.workers().for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        Scratch scratch;
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            if ((marks_[u] & kStale) != 0) {
                propose(u, scratch);
            } else if ((marks_[u] & kReview) != 0) {
                review(u, scratch);
            }
        }
    });
    for (std::uint64_t i = 0; i < n_live_; ++i) marks_[live_[i]] = 0;
}

/// The cost, as bits, up to which proposals may be carried out in this round: a quantile, from a
/// histogram of the leading bits of the costs, which are in the order of the numbers. 0: there is
/// no proposal.
std::uint64_t EdgeCollapse::cost_bound(std::uint64_t needed) const {
    constexpr unsigned kShift = 15;
    std::vector<std::uint32_t> histogram(1U << (32 - kShift));
    std::uint64_t n_proposals = 0;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const float cost = proposals_[live_[i]].cost;
        if (cost == kNoCost) continue;
        ++histogram[std::bit_cast<std::uint32_t>(cost) >> kShift];
        ++n_proposals;
    }
    if (n_proposals == 0) return 0;
    const double share = std::clamp(
        kProposalsPerCollapse * static_cast<double>(needed) / static_cast<double>(n_proposals),
        kLeastRoundShare, kRoundShare);
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(n_proposals)) + 1;
    std::uint64_t sum = 0;
    std::uint64_t bucket = 0;
    while ((sum += histogram[bucket]) < wanted) ++bucket;
    return (bucket + 1) << kShift;
}

namespace {

bool is_cheap(float cost, std::uint64_t bound) {
    return std::bit_cast<std::uint32_t>(cost) < bound;
}

}  // namespace

/// All that a collapse reads or writes goes to its best claimant.
void EdgeCollapse::claim_neighbourhoods(std::uint64_t bound) {
    context_.workers().for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        Scratch s;
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            if (!is_cheap(proposals_[u].cost, bound)) continue;
            if (!is_checked(u)) {
                check(u, s);
                if (!is_cheap(proposals_[u].cost, bound)) continue;
            }
            gather_edge(u, proposals_[u].partner, s);
            const std::uint64_t key = claim_key(proposals_[u].cost, u);
            for (const std::uint32_t w : s.around_u) claim(claims_[w], key);
            for (const std::uint32_t w : s.around_v) claim(claims_[w], key);
        }
        context_.check_stop();
    });
}

/// Proposals that hold both of their ends: then no end of another winner is among their neighbours.
std::vector<std::uint64_t> EdgeCollapse::find_winners(std::uint64_t bound) const {
    std::vector<std::uint64_t> winners;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t u = live_[i];
        const Proposal proposal = proposals_[u];
        if (!is_cheap(proposal.cost, bound)) continue;
        const std::uint64_t key = claim_key(proposal.cost, u);
        if (claims_[u] == key && claims_[proposal.partner] == key) winners.push_back(key);
    }
    std::sort(winners.begin(), winners.end());
    return winners;
}

std::uint64_t EdgeCollapse::carry_out(const std::vector<std::uint64_t>& winners,
                                      std::uint64_t most) {
    std::atomic<std::uint64_t> removed_faces{0};
    std::atomic<std::uint64_t> removed_vertices{0};
    const std::uint64_t n = std::min<std::uint64_t>(winners.size(), most);
    context_.workers().for_ranges(n, 64, [&](std::uint64_t begin, std::uint64_t end) {
        Scratch s;
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint64_t key = winners[i];
            const auto u = static_cast<std::uint32_t>(key);
            const std::uint32_t v = proposals_[u].partner;
            gather_edge(u, v, s);
            // No vertex may lose faces to two collapses at once.
            if (std::any_of(s.opposite.begin(), s.opposite.end(),
                            [&](std::uint32_t w) { return claims_[w] != key; })) {
                continue;
            }
            collapse(u, v, s);
            removed_faces.fetch_add(s.opposite.size(), std::memory_order_relaxed);
            removed_vertices.fetch_add(1, std::memory_order_relaxed);
        }
    });
    n_triangles_ -= removed_faces;
    n_vertices_ -= removed_vertices;
    return removed_vertices;
}

/// An inner edge takes two triangles with it.
std::uint64_t EdgeCollapse::n_needed(const CollapseTarget& target) const {
    const auto excess = [](std::uint64_t have, std::uint64_t most) {
        return have > most ? have - most : 0;
    };
    return std::max((excess(n_triangles_, target.most_triangles) + 1) / 2,
                    excess(n_vertices_, target.most_vertices));
}

std::uint64_t EdgeCollapse::n_expected(const CollapseTarget& target) const {
    return target.most_displacement ? 0 : n_needed(target);
}

std::uint64_t EdgeCollapse::round(const CollapseTarget& target) {
    ++round_;
    refresh_proposals();
    const std::uint64_t needed = n_needed(target);
    const std::uint64_t bound = cost_bound(needed);
    if (bound == 0) return 0;
    claim_neighbourhoods(bound);
    const std::uint64_t n = carry_out(find_winners(bound), needed);
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        if (is_live(live_[i])) live_[kept++] = live_[i];
    }
    n_live_ = kept;
    return n;
}

std::uint64_t EdgeCollapse::run(const CollapseTarget& target) {
    if (target.most_displacement != most_displacement_) {
        // What the bound before this one forbade may be possible now.
        for (std::uint64_t i = 0; i < n_live_; ++i) marks_[live_[i]] |= kStale;
        most_displacement_ = target.most_displacement;
    }
    std::uint64_t n = 0;
    // A round may fail to collapse anything because the proposals it looked at turned out to be
    // impossible; each such round settles some of them. Many in a row mean that nothing is left to
    // do.
    int idle = 0;
    while (!is_met(target) && idle < kMostIdleRounds) {
        const std::uint64_t done = round(target);
        n += done;
        idle = done == 0 ? idle + 1 : 0;
        context_.advance(done);
    }
    return n;
}

}  // namespace hewer::rsimp
