// SPDX-License-Identifier: MIT
#include "rsimp/manifold.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/duplicate_faces.h"
#include "rsimp/face_components.h"
#include "rsimp/fan_vertices.h"
#include "rsimp/half_edges.h"
#include "rsimp/necks.h"

namespace hewer::rsimp {

namespace {

// Components with more faces are kept even where they touch a larger one.
constexpr std::uint32_t kMostFacesOfBubble = 8;

/// The fans of faces around the open clusters of a mesh, whose faces are settled.
class Fans {
  public:
    explicit Fans(BlockMesh& mesh)
        : mesh_(mesh),
          is_open_(mesh.vertices.size()),
          opposite_(3 * mesh.faces.size(), kNoIndex),
          named_(mesh.faces),
          has_changed_(mesh.vertices.size(), 1) {
        constexpr std::uint32_t kBoth = VertexFlags::kRaw | VertexFlags::kFrozen;
        for (std::size_t v = 0; v < is_open_.size(); ++v) {
            is_open_[v] = (mesh.vertices[v].flags & kBoth) == VertexFlags::kRaw;
        }
        for_each_edge(mesh_.faces, mesh_.vertices.size(),
                      [&](std::uint32_t low, std::span<const HalfEdge> group) {
                          if (group.size() == 2) {
                              pair(group[0].id, group[1].id);
                          } else if (group.size() > 2 &&
                                     (is_open_[low] != 0 || is_open_[group[0].other] != 0)) {
                              pair_many(low, group);
                              for (const HalfEdge& h : group) crowded_.push_back(h.id);
                          }
                      });
        name_fans();
        // A round makes more vertices, of which there are at most three for each face, or opens
        // edges, or freezes vertices: this ends.
        bool is_stuck = false;
        for (;;) {
            const std::size_t before = n_vertices();
            const auto [n_met, n_frozen] = cut_double_edges(is_stuck);
            if (n_met == 0) break;
            name_fans();
            is_stuck = n_frozen == 0 && n_vertices() <= before;
        }
    }

    /// Faces with a vertex for each fan: those of `mesh`, then one for each of extra().
    [[nodiscard]] std::vector<LocalFace>& named() { return named_; }
    /// Vertex of the mesh that each of the additional ones was cut from.
    [[nodiscard]] const std::vector<std::uint32_t>& extra() const { return extra_; }
    [[nodiscard]] bool has_opposite(std::uint64_t half_edge) const {
        return opposite_[half_edge] != kNoIndex;
    }
    [[nodiscard]] std::size_t n_vertices() const { return mesh_.vertices.size() + extra_.size(); }
    [[nodiscard]] std::uint32_t origin(std::uint32_t v) const {
        return v < mesh_.vertices.size() ? v : extra_[v - mesh_.vertices.size()];
    }

  private:
    void pair(std::uint32_t a, std::uint32_t b) {
        opposite_[a] = b;
        opposite_[b] = a;
    }

    /// Pairs the half-edges of an edge with more than two faces.
    void pair_many(std::uint32_t low, std::span<const HalfEdge> group) {
        const Vec3& a = mesh_.position(low);
        const Vec3& b = mesh_.position(group[0].other);
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
            const LocalFace& face = mesh_.faces[group[i].id / 3];
            is_forward[i] = face[group[i].id % 3] == low;
            const Vec3 arm = mesh_.position(face[(group[i].id % 3 + 2) % 3]) - a;
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
            pair(group[c.i].id, group[c.j].id);
        }
    }

    /// Walks the fans of the clusters that have changed: the first keeps the cluster's vertex, each
    /// further one gets another, in the order of their first corners.
    void name_fans() {
        const auto& faces = mesh_.faces;
        std::vector<std::uint8_t> has_name(3 * faces.size());
        // The first of each cluster's extra vertices that is not taken, and where to look on.
        std::vector<std::uint32_t> next_extra(mesh_.vertices.size(), kNoIndex);
        std::vector<std::uint32_t> extra_after(extra_.size(), kNoIndex);
        for (auto e = static_cast<std::uint32_t>(extra_.size()); e-- > 0;) {
            extra_after[e] = std::exchange(next_extra[extra_[e]], e);
        }
        std::vector<std::uint8_t> has_fan(mesh_.vertices.size());
        for (std::uint32_t f = 0; f < faces.size(); ++f) {
            for (std::uint32_t i = 0; i < 3; ++i) {
                const std::uint32_t cluster = faces[f][i];
                if (has_changed_[cluster] == 0 || has_name[3 * f + i] != 0) continue;
                std::uint32_t vertex = cluster;
                if (is_open_[cluster] == 0) {
                    named_[f][i] = cluster;
                    continue;
                }
                if (std::exchange(has_fan[cluster], 1) != 0) {
                    std::uint32_t& extra = next_extra[cluster];
                    if (extra != kNoIndex) {
                        vertex = static_cast<std::uint32_t>(mesh_.vertices.size()) + extra;
                        extra = extra_after[extra];
                    } else {
                        vertex = static_cast<std::uint32_t>(n_vertices());
                        extra_.push_back(cluster);
                    }
                }
                walk_fan(f, i, vertex, has_name);
            }
        }
        // A cluster may have fewer fans than before.
        std::vector<std::uint8_t> is_unused(extra_.size());
        bool is_any_unused = false;
        for (std::size_t v = 0; v < has_changed_.size(); ++v) {
            if (std::exchange(has_changed_[v], 0) == 0) continue;
            for (std::uint32_t e = next_extra[v]; e != kNoIndex; e = extra_after[e]) {
                is_unused[e] = 1;
                is_any_unused = true;
            }
        }
        if (is_any_unused) drop_extra(is_unused);
    }

    void drop_extra(std::span<const std::uint8_t> is_unused) {
        const auto n_before = static_cast<std::uint32_t>(mesh_.vertices.size());
        std::vector<std::uint32_t> new_vertex(extra_.size());
        std::uint32_t n = 0;
        for (std::size_t e = 0; e < extra_.size(); ++e) {
            new_vertex[e] = n_before + n;
            if (is_unused[e] == 0) extra_[n++] = extra_[e];
        }
        extra_.resize(n);
        for (LocalFace& face : named_) {
            for (std::uint32_t& v : face) {
                if (v >= n_before) v = new_vertex[v - n_before];
            }
        }
    }

    /// From this corner over the edge that leaves it, and over the one that arrives.
    void walk_fan(std::uint32_t f, std::uint32_t i, std::uint32_t vertex,
                  std::vector<std::uint8_t>& has_name) {
        const auto& faces = mesh_.faces;
        const std::uint32_t cluster = faces[f][i];
        for (const std::uint32_t first_edge : {3 * f + i, 3 * f + (i + 2) % 3}) {
            std::uint32_t face = f;
            std::uint32_t corner = i;
            std::uint32_t edge = first_edge;
            for (;;) {
                named_[face][corner] = vertex;
                has_name[3 * face + corner] = 1;
                const std::uint32_t next = opposite_[edge];
                if (next == kNoIndex) break;
                face = next / 3;
                const std::uint32_t start = next % 3;
                // The corner of the next face at our cluster, and its other edge there.
                corner = faces[face][start] == cluster ? start : (start + 1) % 3;
                edge = corner == start ? 3 * face + (start + 2) % 3 : 3 * face + corner;
                if (has_name[3 * face + corner] != 0) break;
            }
        }
    }

    /// Two sheets that meet along an edge may be one fan around both of its ends: then two edges
    /// join the same two vertices. Cutting along that loop of two edges and closing both sides,
    /// which is to exchange partners, makes two vertices of each end. On a surface that is not
    /// orientable it may not: with `is_stuck` the loops stay open instead. Where one end is frozen,
    /// the other is frozen too. Returns how many loops were met, and how many vertices frozen.
    std::pair<std::uint64_t, std::uint64_t> cut_double_edges(bool is_stuck) {
        // One cut at a vertex in a round: two could undo each other.
        std::unordered_set<std::uint32_t> used;
        std::uint64_t n = 0;
        std::uint64_t n_frozen = 0;
        struct Edge {
            std::uint32_t low;
            std::uint32_t high;
            std::uint32_t id;
            [[nodiscard]] bool is_same(const Edge& other) const {
                return low == other.low && high == other.high;
            }
        };
        std::vector<Edge> edges;
        edges.reserve(crowded_.size());
        for (const std::uint32_t id : crowded_) {
            const LocalFace& face = named_[id / 3];
            const auto [low, high] = std::minmax(face[id % 3], face[(id % 3 + 1) % 3]);
            edges.push_back({low, high, id});
        }
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return std::tie(a.low, a.high, a.id) < std::tie(b.low, b.high, b.id);
        });
        for (std::size_t i = 0; i < edges.size();) {
            std::size_t j = i + 1;
            while (j < edges.size() && edges[j].is_same(edges[i])) ++j;
            const std::span<const Edge> group = std::span(edges).subspan(i, j - i);
            i = j;
            if (group.size() < 3) continue;
            const std::uint32_t low = group[0].low;
            const std::uint32_t high = group[0].high;
            const bool low_is_open = is_open_[origin(low)] != 0;
            const bool high_is_open = is_open_[origin(high)] != 0;
            if (!low_is_open && !high_is_open) continue;
            ++n;
            if (!low_is_open || !high_is_open) {
                const std::uint32_t v = origin(low_is_open ? low : high);
                mesh_.vertices[v].flags |= VertexFlags::kFrozen;
                is_open_[v] = 0;
                has_changed_[v] = 1;
                ++n_frozen;
                continue;
            }
            if (used.contains(low) || used.contains(high)) continue;
            used.insert(low);
            used.insert(high);
            has_changed_[origin(low)] = has_changed_[origin(high)] = 1;
            const auto is_forward = [&](std::uint32_t id) { return named_[id / 3][id % 3] == low; };
            const std::uint32_t p = group[0].id;
            const std::uint32_t q = opposite_[p];
            const auto partner =
                std::find_if(group.begin(), group.end(), [&](const Edge& candidate) {
                    const std::uint32_t r = candidate.id;
                    return r != p && r != q && opposite_[r] != kNoIndex &&
                           is_forward(r) == is_forward(p);
                });
            if (is_stuck || q == kNoIndex || partner == group.end()) {
                for (const Edge& edge : group) opposite_[edge.id] = kNoIndex;
                continue;
            }
            const std::uint32_t r = partner->id;
            const std::uint32_t s = opposite_[r];
            pair(p, s);
            pair(r, q);
        }
        return {n, n_frozen};
    }

    BlockMesh& mesh_;
    std::vector<std::uint8_t> is_open_;    // clusters that get a vertex for each fan
    std::vector<std::uint32_t> opposite_;  // by half-edge
    std::vector<std::uint32_t> crowded_;   // half-edges of edges with more than two faces
    std::vector<LocalFace> named_;
    std::vector<std::uint32_t> extra_;
    std::vector<std::uint8_t> has_changed_;  // clusters whose pairs have, since fans were named
};

/// Components of a few faces with a border, each of them a copy of one before in another component:
/// faces that are there twice in the input. By label.
std::vector<bool> find_copies(const BlockMesh& mesh, const Fans& fans,
                              std::span<const LocalFace> named,
                              std::span<const std::uint32_t> label) {
    std::vector<std::uint32_t> n_faces(label.size());
    std::vector<bool> is_copy(label.size());
    for (std::size_t f = 0; f < named.size(); ++f) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (!fans.has_opposite(3 * f + i)) is_copy[label[named[f][0]]] = true;
        }
    }
    for (std::size_t f = 0; f < named.size(); ++f) {
        const std::uint32_t c = label[named[f][0]];
        // Faces are settled: copies follow each other.
        const bool is_copied =
            f > 0 && mesh.faces[f] == mesh.faces[f - 1] && label[named[f - 1][0]] != c;
        if (!is_copied || ++n_faces[c] > kMostFacesOfBubble) is_copy[c] = false;
        for (const std::uint32_t v : named[f]) {
            const std::uint32_t flags = mesh.vertices[fans.origin(v)].flags;
            if (VertexFlags::has_faces_elsewhere(flags)) is_copy[c] = false;
        }
    }
    return is_copy;
}

/// Folding pinches off bubbles: small closed components that share clusters with a larger one. They
/// stand for nothing of their own, and dropping a closed component opens nothing. Nor does a
/// triangle that is there twice, once for each side, make a closed surface. Faces are dropped from
/// fans.named(); their edges become links.
std::uint64_t drop_bubbles(const BlockMesh& mesh, Fans& fans, std::vector<LocalFace>& links) {
    std::vector<LocalFace>& named = fans.named();
    const std::vector<std::uint32_t> label = component_labels(fans.n_vertices(), named);
    // Open and unfinished components count as large ones.
    std::vector<std::uint32_t> n_faces(label.size());
    constexpr std::uint32_t kLarge = 1U << 30;
    constexpr std::uint32_t kTriangleTwice = 2;  // faces
    for (std::size_t f = 0; f < named.size(); ++f) {
        std::uint32_t& n = n_faces[label[named[f][0]]];
        if (n < kLarge) ++n;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t flags = mesh.vertices[fans.origin(named[f][i])].flags;
            if (!fans.has_opposite(3 * f + i) || VertexFlags::has_faces_elsewhere(flags)) {
                n = kLarge;
            }
        }
    }
    // The component with the most faces at each cluster; ties go to the lower label.
    std::vector<std::uint32_t> largest(mesh.vertices.size(), kNoIndex);
    for (std::uint32_t v = 0; v < label.size(); ++v) {
        const std::uint32_t c = label[v];
        std::uint32_t& best = largest[fans.origin(v)];
        if (best == kNoIndex || n_faces[c] > n_faces[best] ||
            (n_faces[c] == n_faces[best] && c < best)) {
            best = c;
        }
    }
    std::vector<bool> is_bubble = find_copies(mesh, fans, named, label);
    for (std::uint32_t v = 0; v < label.size(); ++v) {
        const std::uint32_t c = label[v];
        const bool is_small = n_faces[c] <= kMostFacesOfBubble;
        if ((is_small && largest[fans.origin(v)] != c) || n_faces[c] == kTriangleTwice) {
            is_bubble[c] = true;
        }
    }
    const auto is_finished = [&](const LocalFace& t) {
        return std::none_of(t.begin(), t.end(), [&](std::uint32_t v) {
            return (mesh.vertices[fans.origin(v)].flags & VertexFlags::kFrozen) != 0;
        });
    };
    std::size_t n = 0;
    for (const LocalFace& t : named) {
        // Copies that no fan parts, and no later block will.
        const bool is_same_again = n > 0 && t == named[n - 1] && is_finished(t);
        if (!is_same_again && !is_bubble[label[t[0]]]) {
            named[n++] = t;
            continue;
        }
        const std::uint32_t a = fans.origin(t[0]);
        const std::uint32_t b = fans.origin(t[1]);
        const std::uint32_t c = fans.origin(t[2]);
        links.insert(links.end(), {{a, b, b}, {b, c, c}});
    }
    const std::uint64_t n_dropped = named.size() - n;
    named.resize(n);
    return n_dropped;
}

}  // namespace

ManifoldCounts make_manifold(BlockMesh& mesh, SurfaceKind kind, std::uint64_t* next_fan) {
    ManifoldCounts counts;
    const auto first_link =
        std::partition(mesh.faces.begin(), mesh.faces.end(), std::not_fn(is_degenerate));
    std::vector<LocalFace> links(first_link, mesh.faces.end());
    mesh.faces.erase(first_link, mesh.faces.end());
    std::vector<bool> had_face(mesh.vertices.size());
    for (const LocalFace& t : mesh.faces) {
        for (const std::uint32_t v : t) had_face[v] = true;
    }
    counts.cancelled_faces = settle_duplicates(mesh.faces, kind.is_closed);
    std::vector<std::uint32_t> extra;
    {
        Fans fans(mesh);
        counts.bubble_faces = drop_bubbles(mesh, fans, links);
        extra = fans.extra();
        mesh.faces = std::move(fans.named());
    }
    if (kind.has_links && !(extra.empty() && links.empty())) {
        counts.joined_necks = join_necks(mesh, extra, links, mesh.faces);
    }
    const std::size_t n_before = mesh.vertices.size();
    counts.cut_vertices = add_fan_vertices(mesh, extra, next_fan);

    std::vector<bool> is_used(mesh.vertices.size());
    std::vector<bool> has_vertex(n_before);  // of the clusters
    for (const LocalFace& t : mesh.faces) {
        for (const std::uint32_t v : t) {
            is_used[v] = true;
            has_vertex[v < n_before ? v : extra[v - n_before]] = true;
        }
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        StoredVertex& vertex = mesh.vertices[v];
        if ((vertex.flags & VertexFlags::kFrozen) != 0) {
            is_used[v] = true;  // has faces elsewhere
        } else {
            if (v < n_before && !has_vertex[v]) {
                counts.lost_cells += vertex.n_cells;
                if (had_face[v] || vertex.n_cells != 1) {
                    counts.lost.push_back({vertex.vertex.box, vertex.n_cells, 0});
                }
            }
            vertex.flags &= ~VertexFlags::kRaw;
        }
    }
    keep_vertices(mesh, is_used);
    sort_vertices(mesh);
    return counts;
}

}  // namespace hewer::rsimp
