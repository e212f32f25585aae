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

namespace hewer::rsimp {

namespace {

constexpr std::uint8_t kStale = 1;    // the proposal must be made anew
constexpr std::uint8_t kTouched = 2;  // the corner list may hold dead faces
constexpr float kNoCost = std::numeric_limits<float>::infinity();
constexpr std::uint64_t kGrain = 2048;

// The cheapest part of all proposals that a round may carry out: small enough to stay close to the
// greedy order, large enough to be done in a few dozen rounds.
constexpr double kRoundShare = 0.25;
constexpr double kLeastRoundShare = 0.01;
// About one proposal in three is the best of its neighbourhood.
constexpr double kProposalsPerCollapse = 3;

// Pull towards the area-weighted mean of the two ends, relative to the quadric's trace: decides where the
// planes do not. On a flat patch it keeps triangles even.
constexpr double kPull = 1e-3;
// Cost of an edge's length, relative to trace times squared length: among equals the shortest goes first.
constexpr double kLengthCost = 1e-6;
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
    std::vector<std::pair<double, std::uint32_t>> edges;
};

EdgeCollapse::EdgeCollapse(ooc::Context& context, CollapseMesh mesh)
    : context_(context),
      mesh_(std::move(mesh)),
      n_triangles_(mesh_.triangles.size()),
      n_vertices_(mesh_.positions.size()),
      next_corner_(context.budget(), "corner lists", 3 * n_triangles_),
      first_corner_(context.budget(), "corner lists", n_vertices_),
      parent_(context.budget(), "collapse parents", n_vertices_),
      proposals_(context.budget(), "proposals", n_vertices_),
      claims_(context.budget(), "claims", n_vertices_),
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

bool contains(const CellTriple& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

}  // namespace

bool EdgeCollapse::keeps_type(std::uint32_t u, std::uint32_t v, const Scratch& s) const {
    if (s.opposite.empty() || s.opposite.size() > 2) return false;
    // Link condition: the only neighbours in common are the third corners of the faces at the edge.
    std::size_t n_common = 0;
    for (std::size_t i = 0; i < s.around_u.size(); ++i) {
        const std::uint32_t w = s.around_u[i];
        if (w == v || std::find(s.around_v.begin(), s.around_v.end(), w) == s.around_v.end()) continue;
        const auto seen = s.around_u.begin() + static_cast<std::ptrdiff_t>(i);
        if (std::find(s.around_u.begin(), seen, w) == seen) ++n_common;
    }
    if (n_common != s.opposite.size()) return false;
    // Two border vertices joined by an inner edge: the surface would be pinched.
    if (s.opposite.size() == 2 && has_single(s.around_u) && has_single(s.around_v)) return false;
    // The third corners lose a face: what is left around them must still be a fan.
    std::vector<std::uint32_t> faces;
    std::vector<std::uint32_t> around;
    for (const std::uint32_t w : s.opposite) {
        gather_ring(w, faces);
        if (faces.size() >= 4) continue;
        gather_neighbours(mesh_.triangles, faces, w, around);
        if (faces.size() < (has_single(around) ? 2U : 4U)) return false;
    }
    (void)u;
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
            const Vec3& a = mesh_.positions[t[(i + 1) % 3]];
            const Vec3& b = mesh_.positions[t[(i + 2) % 3]];
            const Vec3 ab = b - a;
            const Vec3 before = cross(ab, mesh_.positions[moved] - a);
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

namespace {

/// Minimum of q with the pull towards `anchor`.
Vec3 pulled_minimum(const cluster::Quadric& q, const Vec3& anchor) {
    const Vec3 g = q.a * anchor + q.b;
    const double mu = kPull * q.trace() + 1e-12;
    const double xx = q.a[0] + mu;
    const double xy = q.a[1];
    const double xz = q.a[2];
    const double yy = q.a[3] + mu;
    const double yz = q.a[4];
    const double zz = q.a[5] + mu;
    // Cofactors; the matrix is positive definite.
    const double c00 = yy * zz - yz * yz;
    const double c01 = xz * yz - xy * zz;
    const double c02 = xy * yz - xz * yy;
    const double det = xx * c00 + xy * c01 + xz * c02;
    if (!(det > 0)) return anchor;
    const double c11 = xx * zz - xz * xz;
    const double c12 = xy * xz - xx * yz;
    const double c22 = xx * yy - xy * xy;
    const double r = -1 / det;
    return anchor + Vec3{r * (c00 * g[0] + c01 * g[1] + c02 * g[2]),
                         r * (c01 * g[0] + c11 * g[1] + c12 * g[2]),
                         r * (c02 * g[0] + c12 * g[1] + c22 * g[2])};
}

struct EdgeQuadric {
    cluster::Quadric quadric;
    Vec3 optimum{};
    double length_cost = 0;

    EdgeQuadric(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v) {
        quadric = mesh.quadrics[u];
        quadric += mesh.quadrics[v];
        const double wu = mesh.quadrics[u].trace() + 1e-12;
        const double wv = mesh.quadrics[v].trace() + 1e-12;
        const Vec3& pu = mesh.positions[u];
        const Vec3& pv = mesh.positions[v];
        optimum = pulled_minimum(quadric, (1 / (wu + wv)) * (wu * pu + wv * pv));
        const auto& bu = mesh.boxes[u];
        const auto& bv = mesh.boxes[v];
        for (std::size_t i = 0; i < 3; ++i) {
            optimum[i] = std::clamp(optimum[i], static_cast<double>(std::min(bu[i], bv[i])),
                                    static_cast<double>(std::max(bu[3 + i], bv[3 + i])));
        }
        const Vec3 edge = pv - pu;
        length_cost = kLengthCost * (wu + wv) * dot(edge, edge);
    }
    [[nodiscard]] double cost(const Vec3& x) const {
        return std::max(0.0, quadric.error(x)) + length_cost;
    }
};

double displacement(const CollapseMesh& mesh, std::uint32_t u, std::uint32_t v, const Vec3& x) {
    Vec3 low;
    Vec3 high;
    for (std::size_t i = 0; i < 3; ++i) {
        low[i] = static_cast<double>(std::min(mesh.boxes[u][i], mesh.boxes[v][i]));
        high[i] = static_cast<double>(std::max(mesh.boxes[u][3 + i], mesh.boxes[v][3 + i]));
    }
    return farthest_corner(low, high, x);
}

}  // namespace

std::optional<EdgeCollapse::Placement> EdgeCollapse::place(std::uint32_t u, std::uint32_t v,
                                                           Scratch& scratch) const {
    const EdgeQuadric edge(mesh_, u, v);
    const Vec3& pu = mesh_.positions[u];
    const Vec3& pv = mesh_.positions[v];
    std::optional<Placement> best;
    const auto consider = [&](const Vec3& x) {
        if (most_displacement_ && displacement(mesh_, u, v, x) > *most_displacement_) return;
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

void EdgeCollapse::propose(std::uint32_t u, Scratch& s) {
    Proposal best{kNoCost, kNoIndex};
    gather_ring(u, s.faces_u);
    gather_neighbours(mesh_.triangles, s.faces_u, u, s.around_u);
    s.edges.clear();
    for (std::size_t i = 0; i < s.around_u.size(); ++i) {
        const std::uint32_t v = s.around_u[i];
        // Each edge is proposed by its smaller vertex.
        if (v < u) continue;
        const auto seen = s.around_u.begin() + static_cast<std::ptrdiff_t>(i);
        if (std::find(s.around_u.begin(), seen, v) != seen) continue;
        const EdgeQuadric edge(mesh_, u, v);
        s.edges.emplace_back(edge.cost(edge.optimum), v);
    }
    std::sort(s.edges.begin(), s.edges.end());
    for (const auto& [cost, v] : s.edges) {
        if (cost >= static_cast<double>(best.cost)) break;  // penalties only raise costs
        gather_ring(v, s.faces_v);
        gather_neighbours(mesh_.triangles, s.faces_v, v, s.around_v);
        s.opposite.clear();
        for (const std::uint32_t f : s.faces_u) {
            const CellTriple& t = mesh_.triangles[f];
            if (contains(t, v)) s.opposite.push_back(t[0] ^ t[1] ^ t[2] ^ u ^ v);
        }
        if (!keeps_type(u, v, s)) continue;
        const auto placement = place(u, v, s);
        if (placement && placement->cost < static_cast<double>(best.cost)) {
            best = {static_cast<float>(placement->cost), v};
        }
    }
    proposals_[u] = best;
}

void EdgeCollapse::collapse(std::uint32_t u, std::uint32_t v, Scratch& s) {
    const auto placement = place(u, v, s);
    mesh_.quadrics[u] += mesh_.quadrics[v];
    for (std::size_t i = 0; i < 3; ++i) {
        mesh_.boxes[u][i] = std::min(mesh_.boxes[u][i], mesh_.boxes[v][i]);
        mesh_.boxes[u][3 + i] = std::max(mesh_.boxes[u][3 + i], mesh_.boxes[v][3 + i]);
    }
    mesh_.positions[u] = placement->position;
    if (!mesh_.attributes.empty()) {
        auto& a = mesh_.attributes[u];
        const auto& b = mesh_.attributes[v];
        for (std::size_t i = 0; i < 3; ++i) a.normal[i] += b.normal[i];
        for (std::size_t i = 0; i < 3; ++i) a.face_normal[i] += b.face_normal[i];
        for (std::size_t i = 0; i < 4; ++i) a.color[i] += b.color[i];
        a.n_colors += b.n_colors;
    }
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
    mark(marks_[u], kStale | kTouched);
    for (const auto* around : {&s.around_u, &s.around_v}) {
        for (const std::uint32_t w : *around) {
            if (w != u && w != v) mark(marks_[w], kStale | kTouched);
        }
    }
}

std::uint64_t EdgeCollapse::round(const CollapseTarget& target) {
    ooc::Workers& workers = context_.workers();
    workers.for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            if ((marks_[u] & kTouched) != 0) {
                prune(u);
                marks_[u] &= static_cast<std::uint8_t>(~kTouched);
            }
            claims_[u] = std::numeric_limits<std::uint64_t>::max();
        }
    });
    workers.for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        Scratch scratch;
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            if ((marks_[u] & kStale) == 0) continue;
            propose(u, scratch);
            marks_[u] = 0;
        }
    });

    // The cost below which proposals may be carried out: a quantile, from a histogram of the leading bits
    // of the costs, which are in the order of the numbers.
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
    const auto excess = [](std::uint64_t have, std::uint64_t most) {
        return have > most ? have - most : 0;
    };
    const std::uint64_t needed = std::max((excess(n_triangles_, target.most_triangles) + 1) / 2,
                                          excess(n_vertices_, target.most_vertices));
    const double share = std::clamp(
        kProposalsPerCollapse * static_cast<double>(needed) / static_cast<double>(n_proposals),
        kLeastRoundShare, kRoundShare);
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(n_proposals)) + 1;
    std::uint64_t sum = 0;
    std::uint32_t bucket = 0;
    while ((sum += histogram[bucket]) < wanted) ++bucket;
    const std::uint64_t bound = (static_cast<std::uint64_t>(bucket) + 1) << kShift;
    const auto is_cheap = [&](float cost) { return std::bit_cast<std::uint32_t>(cost) < bound; };

    const auto gather_edge = [&](std::uint32_t u, std::uint32_t v, Scratch& s) {
        gather_ring(u, s.faces_u);
        gather_ring(v, s.faces_v);
        gather_neighbours(mesh_.triangles, s.faces_u, u, s.around_u);
        gather_neighbours(mesh_.triangles, s.faces_v, v, s.around_v);
        s.opposite.clear();
        for (const std::uint32_t f : s.faces_u) {
            const CellTriple& t = mesh_.triangles[f];
            if (contains(t, v)) s.opposite.push_back(t[0] ^ t[1] ^ t[2] ^ u ^ v);
        }
    };
    // Claims: all that a collapse reads or writes goes to its best claimant.
    workers.for_ranges(n_live_, kGrain, [&](std::uint64_t begin, std::uint64_t end) {
        Scratch s;
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint32_t u = live_[i];
            const Proposal proposal = proposals_[u];
            if (proposal.cost == kNoCost || !is_cheap(proposal.cost)) continue;
            gather_edge(u, proposal.partner, s);
            // The partner's surroundings may have changed since the proposal was made.
            if (!keeps_type(u, proposal.partner, s) || !place(u, proposal.partner, s)) {
                mark(marks_[u], kStale);
                continue;
            }
            const std::uint64_t key = claim_key(proposal.cost, u);
            for (const std::uint32_t w : s.around_u) claim(claims_[w], key);
            for (const std::uint32_t w : s.around_v) claim(claims_[w], key);
        }
    });
    // A winner holds both ends and the third corners: then no end of another winner is among its
    // neighbours, and no vertex loses faces to two of them.
    std::vector<std::uint64_t> winners;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t u = live_[i];
        const Proposal proposal = proposals_[u];
        if (proposal.cost == kNoCost || !is_cheap(proposal.cost) || (marks_[u] & kStale) != 0) continue;
        const std::uint64_t key = claim_key(proposal.cost, u);
        if (claims_[u] == key && claims_[proposal.partner] == key) winners.push_back(key);
    }
    std::sort(winners.begin(), winners.end());
    std::atomic<std::uint64_t> removed_faces{0};
    std::atomic<std::uint64_t> removed_vertices{0};
    const auto apply = [&](std::uint64_t first, std::uint64_t last) {
        workers.for_ranges(last - first, 64, [&](std::uint64_t begin, std::uint64_t end) {
            Scratch s;
            for (std::uint64_t i = begin; i < end; ++i) {
                const std::uint64_t key = winners[first + i];
                const auto u = static_cast<std::uint32_t>(key);
                const std::uint32_t v = proposals_[u].partner;
                gather_edge(u, v, s);
                if (std::any_of(s.opposite.begin(), s.opposite.end(),
                                [&](std::uint32_t w) { return claims_[w] != key; })) {
                    continue;
                }
                collapse(u, v, s);
                removed_faces.fetch_add(s.opposite.size(), std::memory_order_relaxed);
                removed_vertices.fetch_add(1, std::memory_order_relaxed);
            }
        });
    };
    apply(0, std::min<std::uint64_t>(winners.size(), needed));
    n_triangles_ -= removed_faces;
    n_vertices_ -= removed_vertices;
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        if (is_live(live_[i])) live_[kept++] = live_[i];
    }
    n_live_ = kept;
    return removed_vertices;
}

std::uint64_t EdgeCollapse::run(const CollapseTarget& target) {
    most_displacement_ = target.most_displacement;
    std::uint64_t n = 0;
    // A round in which every winner's claim failed is followed by one with fresh proposals; two without
    // progress mean that there is nothing left to do.
    int idle = 0;
    while (!is_met(target) && idle < 3) {
        const std::uint64_t done = round(target);
        n += done;
        idle = done == 0 ? idle + 1 : 0;
        context_.advance(done);
    }
    return n;
}

std::uint64_t EdgeCollapse::drop_components(const CollapseTarget& target) {
    std::vector<std::uint32_t> label(parent_.size());
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    for (const CellTriple& t : mesh_.triangles) {
        if (t[0] == kNoIndex) continue;
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            label[std::max(a, b)] = std::min(a, b);
        }
    }
    struct Component {
        double size_sq = 0;
        std::uint32_t label = 0;
        std::uint64_t n_triangles = 0;
        std::uint64_t n_vertices = 0;
        std::array<float, 6> box{};
    };
    std::vector<Component> components;
    std::vector<std::uint32_t> index(parent_.size(), kNoIndex);
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t v = live_[i];
        std::uint32_t& at = index[find(v)];
        if (at == kNoIndex) {
            at = static_cast<std::uint32_t>(components.size());
            components.push_back({0, find(v), 0, 0, mesh_.boxes[v]});
        }
        Component& c = components[at];
        ++c.n_vertices;
        for (std::size_t k = 0; k < 3; ++k) {
            c.box[k] = std::min(c.box[k], mesh_.boxes[v][k]);
            c.box[3 + k] = std::max(c.box[3 + k], mesh_.boxes[v][3 + k]);
        }
    }
    for (const CellTriple& t : mesh_.triangles) {
        if (t[0] != kNoIndex) ++components[index[find(t[0])]].n_triangles;
    }
    for (Component& c : components) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = static_cast<double>(c.box[3 + k]) - static_cast<double>(c.box[k]);
            c.size_sq += d * d;
        }
    }
    std::sort(components.begin(), components.end(), [](const Component& a, const Component& b) {
        return a.size_sq != b.size_sq ? a.size_sq < b.size_sq : a.label < b.label;
    });
    std::uint64_t n_dropped = 0;
    std::vector<bool> is_dropped(parent_.size());
    for (std::size_t i = 0; i + 1 < components.size() && !is_met(target); ++i) {
        is_dropped[components[i].label] = true;
        n_triangles_ -= components[i].n_triangles;
        n_vertices_ -= components[i].n_vertices;
        ++n_dropped;
    }
    for (CellTriple& t : mesh_.triangles) {
        if (t[0] != kNoIndex && is_dropped[find(t[0])]) t = {kNoIndex, kNoIndex, kNoIndex};
    }
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < n_live_; ++i) {
        const std::uint32_t v = live_[i];
        if (is_dropped[find(v)]) {
            parent_[v] = kNoIndex;
        } else {
            live_[kept++] = v;
        }
    }
    n_live_ = kept;
    return n_dropped;
}

}  // namespace hewer::rsimp
