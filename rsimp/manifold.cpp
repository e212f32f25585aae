// SPDX-License-Identifier: MIT
#include "rsimp/manifold.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <unordered_set>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/vec3.h"
#include "rsimp/half_edges.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kMostFaces = 0xfffffffeU / 3;  // half-edge ids have 32 bits

// Components with more faces are kept even where they touch a larger one.
constexpr std::uint32_t kMostFacesOfBubble = 8;

/// A face without its smallest vertex, by which faces are bucketed.
struct RestOfFace {
    std::uint32_t second;  // after the smallest, in winding order
    std::uint32_t third;
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> unwound() const {
        return std::minmax(second, third);
    }
    [[nodiscard]] int sign() const { return second < third ? 1 : -1; }
};

bool is_degenerate(const CellTriple& t) {
    return t[0] == t[1] || t[1] == t[2] || t[0] == t[2];
}

/// Non-degenerate faces in canonical order, smallest vertex first, multiplicities settled.
ooc::Array<CellTriple> settle_duplicates(ooc::Context& context, std::span<const CellTriple> triples,
                                         std::uint64_t n_clusters, bool is_closed,
                                         std::uint64_t& n_cancelled) {
    ooc::Array<std::uint64_t> start(context.budget(), "face index", n_clusters + 2);
    std::uint64_t n_faces = 0;
    for (const CellTriple& t : triples) {
        if (is_degenerate(t)) continue;
        ++start[std::min({t[0], t[1], t[2]}) + 2];
        ++n_faces;
    }
    for (std::uint64_t v = 2; v < start.size(); ++v) start[v] += start[v - 1];
    ooc::Array<RestOfFace> rest(context.budget(), "faces", n_faces);
    for (const CellTriple& t : triples) {
        if (is_degenerate(t)) continue;
        const std::size_t i = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
        rest[start[t[i] + 1]++] = {t[(i + 1) % 3], t[(i + 2) % 3]};
    }
    // In each bucket: sort, and let the surviving copies of each face take the places of all.
    ooc::Array<std::uint32_t> kept(context.budget(), "face index", n_clusters + 1);
    context.workers().for_ranges(n_clusters, 1 << 13, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t v = begin; v < end; ++v) {
            RestOfFace* const first = rest.data() + start[v];
            RestOfFace* const last = rest.data() + start[v + 1];
            std::sort(first, last, [](const RestOfFace& a, const RestOfFace& b) {
                const auto ua = a.unwound();
                const auto ub = b.unwound();
                return ua != ub ? ua < ub : a.sign() < b.sign();
            });
            RestOfFace* out = first;
            for (RestOfFace* p = first; p != last;) {
                const auto [low, high] = p->unwound();
                int sum = 0;
                while (p != last && p->unwound() == std::pair(low, high)) sum += (p++)->sign();
                const RestOfFace face{low, high};
                const RestOfFace opposite{high, low};
                if (sum == 0) {
                    *out++ = face;
                    *out++ = opposite;
                    continue;
                }
                for (int copies = is_closed ? std::abs(sum) : 1; copies > 0; --copies) {
                    *out++ = sum > 0 ? face : opposite;
                }
            }
            kept[v] = static_cast<std::uint32_t>(out - first);
        }
    });
    std::uint64_t n_kept = 0;
    for (const std::uint32_t n : kept) n_kept += n;
    n_cancelled = n_faces - n_kept;
    ooc::Array<CellTriple> faces(context.budget(), "faces", n_kept);
    std::uint64_t at = 0;
    for (std::uint64_t v = 0; v < n_clusters; ++v) {
        for (std::uint64_t i = start[v]; i < start[v] + kept[v]; ++i) {
            faces[at++] = {static_cast<std::uint32_t>(v), rest[i].second, rest[i].third};
        }
    }
    return faces;
}

/// Pairs the half-edges of edges with more than two faces.
class EdgePairing {
  public:
    EdgePairing(std::span<const CellTriple> faces, std::span<const Vec3> positions,
                std::span<std::uint32_t> opposite)
        : faces_(faces), positions_(positions), opposite_(opposite) {}

    void pair_many(std::uint32_t low, std::span<const HalfEdge> group) const {
        const Vec3& a = positions_[low];
        const Vec3& b = positions_[group[0].other];
        struct Candidate {
            double bend;
            std::size_t i;
            std::size_t j;
        };
        std::vector<double> angle(group.size());
        std::vector<bool> is_forward(group.size());
        const Vec3 axis = b - a;
        Vec3 x{};
        Vec3 y{};
        for (std::size_t i = 0; i < group.size(); ++i) {
            const CellTriple& face = faces_[group[i].id / 3];
            is_forward[i] = face[group[i].id % 3] == low;
            const Vec3 arm = positions_[face[(group[i].id % 3 + 2) % 3]] - a;
            if (i == 0) {
                y = cross(axis, arm);
                x = cross(y, axis);
                const double lx = std::sqrt(dot(x, x));
                const double ly = std::sqrt(dot(y, y));
                if (lx > 0 && ly > 0) {
                    x = (1 / lx) * x;
                    y = (1 / ly) * y;
                }
            }
            angle[i] = std::atan2(dot(arm, y), dot(arm, x));
        }
        std::vector<Candidate> candidates;
        for (std::size_t i = 0; i < group.size(); ++i) {
            for (std::size_t j = i + 1; j < group.size(); ++j) {
                const double between = std::fabs(angle[i] - angle[j]);
                // Equal windings fit only where orientation is broken: behind all others.
                const double penalty = is_forward[i] != is_forward[j] ? 0 : 100;
                candidates.push_back({std::fabs(between - std::numbers::pi) + penalty, i, j});
            }
        }
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const Candidate& p, const Candidate& q) { return p.bend < q.bend; });
        std::vector<bool> is_paired(group.size());
        for (const Candidate& c : candidates) {
            if (is_paired[c.i] || is_paired[c.j]) continue;
            is_paired[c.i] = is_paired[c.j] = true;
            opposite_[group[c.i].id] = group[c.j].id;
            opposite_[group[c.j].id] = group[c.i].id;
        }
    }

  private:
    std::span<const CellTriple> faces_;
    std::span<const Vec3> positions_;
    std::span<std::uint32_t> opposite_;
};

/// Walks the fans: one vertex for each, numbered in the order of their first corner. `named`
/// receives the faces in those numbers, `cluster_of` the cluster of each. Returns the number of
/// vertices.
std::uint32_t name_fans(std::span<const CellTriple> faces, std::span<const std::uint32_t> opposite,
                        std::span<CellTriple> named, std::span<std::uint32_t> cluster_of) {
    for (CellTriple& t : named) t = {kNoIndex, kNoIndex, kNoIndex};
    std::uint32_t n_vertices = 0;
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (named[f][i] != kNoIndex) continue;
            const std::uint32_t cluster = faces[f][i];
            const std::uint32_t vertex = n_vertices++;
            cluster_of[vertex] = cluster;
            // From this corner over the edge that leaves it, and over the one that arrives.
            for (const std::uint32_t first_edge : {3 * f + i, 3 * f + (i + 2) % 3}) {
                std::uint32_t face = f;
                std::uint32_t corner = i;
                std::uint32_t edge = first_edge;
                for (;;) {
                    named[face][corner] = vertex;
                    const std::uint32_t next = opposite[edge];
                    if (next == kNoIndex) break;
                    face = next / 3;
                    const std::uint32_t start = next % 3;
                    // The corner of the next face at our cluster, and its other edge there.
                    corner = faces[face][start] == cluster ? start : (start + 1) % 3;
                    edge = corner == start ? 3 * face + (start + 2) % 3 : 3 * face + corner;
                    if (named[face][corner] != kNoIndex) break;
                }
            }
        }
    }
    return n_vertices;
}

/// Two sheets that meet along an edge may be one fan around both of its ends: then two edges join
/// the same two vertices. Cutting along that loop of two edges and closing both sides, which is to
/// exchange partners, makes two vertices of each end. On a surface that is not orientable it may
/// not: with `is_stuck` the loops stay open instead. Returns how many loops were cut.
std::uint64_t cut_double_edges(ooc::Context& context, std::span<const CellTriple> named,
                               std::uint64_t n_vertices, bool is_stuck,
                               std::span<std::uint32_t> opposite) {
    struct Edge {
        std::uint32_t low;
        std::vector<HalfEdge> group;
    };
    std::vector<Edge> crowded;
    std::mutex mutex;
    for_each_edge(context, named, n_vertices,
                  [&](std::uint32_t low, std::span<const HalfEdge> group) {
                      if (group.size() < 3) return;
                      const std::lock_guard lock(mutex);
                      crowded.push_back({low, {group.begin(), group.end()}});
                  });
    std::sort(crowded.begin(), crowded.end(), [](const Edge& a, const Edge& b) {
        return a.low != b.low ? a.low < b.low : a.group[0].other < b.group[0].other;
    });
    // One cut at a vertex in a round: two could undo each other.
    std::unordered_set<std::uint32_t> used;
    for (const auto& [low, group] : crowded) {
        if (used.contains(low) || used.contains(group[0].other)) continue;
        used.insert(low);
        used.insert(group[0].other);
        const auto is_forward = [&, v = low](std::uint32_t id) {
            return named[id / 3][id % 3] == v;
        };
        const std::uint32_t p = group[0].id;
        const std::uint32_t q = opposite[p];
        const auto partner =
            std::find_if(group.begin(), group.end(), [&](const HalfEdge& candidate) {
                const std::uint32_t r = candidate.id;
                return r != p && r != q && opposite[r] != kNoIndex &&
                       is_forward(r) == is_forward(p);
            });
        if (is_stuck || q == kNoIndex || partner == group.end()) {
            for (const HalfEdge& h : group) opposite[h.id] = kNoIndex;
            continue;
        }
        const std::uint32_t r = partner->id;
        const std::uint32_t s = opposite[r];
        opposite[p] = s;
        opposite[s] = p;
        opposite[r] = q;
        opposite[q] = r;
    }
    return crowded.size();
}

/// Folding pinches off bubbles: small closed components that share clusters with a larger one. They
/// stand for nothing of their own, and dropping a closed component opens nothing.
std::uint64_t drop_bubbles(ooc::Context& context, ooc::Array<CellTriple>& named,
                           std::span<const std::uint32_t> cluster_of, std::uint64_t n_vertices,
                           std::uint64_t n_clusters, std::span<const std::uint32_t> opposite) {
    ooc::Array<std::uint32_t> label(context.budget(), "components", n_vertices);
    for (std::uint32_t v = 0; v < n_vertices; ++v) label[v] = v;
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    for (const CellTriple& t : named) {
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            label[std::max(a, b)] = std::min(a, b);
        }
    }
    ooc::Array<std::uint32_t> n_faces(context.budget(), "components", n_vertices);
    ooc::Array<std::uint8_t> is_open(context.budget(), "components", n_vertices);
    for (std::uint64_t f = 0; f < named.size(); ++f) {
        const std::uint32_t c = find(named[f][0]);
        ++n_faces[c];
        for (std::uint64_t e = 3 * f; e < 3 * f + 3; ++e) {
            if (opposite[e] == kNoIndex) is_open[c] = 1;
        }
    }
    // The component with the most faces in each cluster; ties go to the lower label.
    ooc::Array<std::uint32_t> largest(context.budget(), "components", n_clusters);
    std::fill(largest.begin(), largest.end(), kNoIndex);
    for (std::uint32_t v = 0; v < n_vertices; ++v) {
        const std::uint32_t c = find(v);
        std::uint32_t& best = largest[cluster_of[v]];
        if (best == kNoIndex || n_faces[c] > n_faces[best] ||
            (n_faces[c] == n_faces[best] && c < best)) {
            best = c;
        }
    }
    ooc::Array<std::uint8_t> is_bubble(context.budget(), "components", n_vertices);
    for (std::uint32_t v = 0; v < n_vertices; ++v) {
        const std::uint32_t c = find(v);
        if (largest[cluster_of[v]] != c && n_faces[c] <= kMostFacesOfBubble && is_open[c] == 0) {
            is_bubble[c] = 1;
        }
    }
    std::uint64_t kept = 0;
    for (const CellTriple& t : named) {
        if (is_bubble[find(t[0])] == 0) named[kept++] = t;
    }
    return named.size() - kept;
}

/// Renumbers what is left after dropping faces, in the order of the old numbers.
void compact(ooc::Context& context, ManifoldMesh& mesh, std::span<const CellTriple> named,
             std::span<const std::uint32_t> cluster_of, std::uint64_t n_vertices,
             std::uint64_t n_clusters) {
    ooc::Array<std::uint32_t> new_index(context.budget(), "vertices", n_vertices);
    for (const CellTriple& t : named) {
        for (const std::uint32_t v : t) new_index[v] = 1;
    }
    std::uint32_t n = 0;
    for (std::uint32_t& index : new_index) index = index != 0 ? n++ : kNoIndex;
    mesh.triangles = {context.budget(), "triangles", named.size()};
    for (std::uint64_t f = 0; f < named.size(); ++f) {
        for (std::size_t i = 0; i < 3; ++i) mesh.triangles[f][i] = new_index[named[f][i]];
    }
    mesh.cluster_of_vertex = {context.budget(), "vertices", n};
    ooc::Array<std::uint8_t> seen(context.budget(), "fans", n_clusters);
    for (std::uint32_t v = 0; v < n_vertices; ++v) {
        if (new_index[v] == kNoIndex) continue;
        mesh.cluster_of_vertex[new_index[v]] = cluster_of[v];
        std::uint8_t& count = seen[cluster_of[v]];
        if (count == 1) ++mesh.n_cut_vertices;
        if (count < 2) ++count;
    }
}

}  // namespace

ManifoldMesh build_manifold(ooc::Context& context, std::span<const CellTriple> triples,
                            std::span<const Vec3> positions, bool is_closed) {
    ManifoldMesh mesh;
    const ooc::Array<CellTriple> faces =
        settle_duplicates(context, triples, positions.size(), is_closed, mesh.n_cancelled);
    if (faces.size() > kMostFaces) {
        throw InternalError("more than " + std::to_string(kMostFaces) +
                            " faces at once; ask for fewer triangles");
    }
    ooc::Array<std::uint32_t> opposite(context.budget(), "edges", 3 * faces.size());
    std::fill(opposite.begin(), opposite.end(), kNoIndex);
    const EdgePairing pairing(faces.span(), positions, opposite.span());
    for_each_edge(context, faces.span(), positions.size(),
                  [&](std::uint32_t low, std::span<const HalfEdge> group) {
                      if (group.size() == 2) {
                          opposite[group[0].id] = group[1].id;
                          opposite[group[1].id] = group[0].id;
                      } else if (group.size() > 2) {
                          pairing.pair_many(low, group);
                      }
                  });
    ooc::Array<CellTriple> named(context.budget(), "triangles", faces.size());
    ooc::Array<std::uint32_t> cluster_of(context.budget(), "fans", 3 * faces.size());
    std::uint32_t n_vertices =
        name_fans(faces.span(), opposite.span(), named.span(), cluster_of.span());
    // A round makes more vertices, of which there are at most three for each face, or opens edges:
    // this ends.
    bool is_stuck = false;
    while (cut_double_edges(context, named.span(), n_vertices, is_stuck, opposite.span()) > 0) {
        const std::uint32_t before = n_vertices;
        n_vertices = name_fans(faces.span(), opposite.span(), named.span(), cluster_of.span());
        is_stuck = n_vertices <= before;
    }
    mesh.n_bubble_faces = drop_bubbles(context, named, cluster_of.span(), n_vertices,
                                       positions.size(), opposite.span());
    compact(context, mesh, named.span().first(named.size() - mesh.n_bubble_faces),
            cluster_of.span(), n_vertices, positions.size());
    return mesh;
}

EdgeCounts count_edges(ooc::Context& context, std::span<const CellTriple> triangles,
                       std::uint64_t n_vertices) {
    std::atomic<std::uint64_t> edges{0};
    std::atomic<std::uint64_t> border{0};
    std::atomic<std::uint64_t> nonmanifold{0};
    for_each_edge(context, triangles, n_vertices,
                  [&](std::uint32_t, std::span<const HalfEdge> group) {
                      edges.fetch_add(1, std::memory_order_relaxed);
                      if (group.size() == 1) border.fetch_add(1, std::memory_order_relaxed);
                      if (group.size() > 2) nonmanifold.fetch_add(1, std::memory_order_relaxed);
                  });
    return {edges, border, nonmanifold};
}

}  // namespace hewer::rsimp
