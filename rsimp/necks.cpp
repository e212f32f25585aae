// SPDX-License-Identifier: MIT
#include "rsimp/necks.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "ooc/vec3.h"
#include "rsimp/face_components.h"

namespace hewer::rsimp {

namespace {

// A surface with more necks than one for so many faces is noise. The triangles would be missed
// elsewhere: with a tube for each neck ct_bonsai's 1 % are 12 % farther from the original.
constexpr std::uint64_t kFacesForATube = 400;

using ClusterPair = std::pair<std::uint32_t, std::uint32_t>;

/// A face at a cluster that may be at a neck, by one of its vertices.
struct FanCorner {
    std::uint32_t cluster;
    std::uint32_t vertex;
    std::uint32_t face;
};

/// Two triangles that could be the ends of a tube.
struct Tube {
    double length;  ///< sum of the squares of its three sides
    FanCorner first;
    FanCorner second;
};

class Necks {
  public:
    Necks(const BlockMesh& mesh, std::span<const std::uint32_t> extra,
          std::vector<LocalFace>& named)
        : mesh_(mesh),
          extra_(extra),
          named_(named),
          label_(component_labels(mesh.vertices.size() + extra.size(), named)),
          is_finished_(label_.size(), true),
          component_of_cluster_(mesh.vertices.size(), kNoIndex),
          is_shared_(mesh.vertices.size()) {
        for (const LocalFace& t : named) {
            for (const std::uint32_t v : t) {
                const std::uint32_t cluster = origin(v);
                if (VertexFlags::has_faces_elsewhere(mesh.vertices[cluster].flags)) {
                    is_finished_[label_[v]] = false;
                }
                std::uint32_t& component = component_of_cluster_[cluster];
                if (component == kNoIndex) component = label_[v];
                if (component != label_[v]) is_shared_[cluster] = true;
            }
        }
    }

    std::uint64_t join(std::span<const LocalFace> links) {
        const std::vector<ClusterPair> pairs = find_pairs(links);
        if (pairs.empty()) return 0;
        const std::uint64_t most = named_.size() / kFacesForATube;
        std::uint64_t n_joined = 0;
        // A tube takes triangles away: what else could be joined with these has its turn in the
        // next round.
        for (;;) {
            const std::uint64_t n_before = n_joined;
            std::vector<bool> is_taken(named_.size());
            find_corners(pairs);
            for (const Tube& tube : find_tubes(pairs)) {
                const std::uint32_t a = component(tube.first.vertex);
                const std::uint32_t b = component(tube.second.vertex);
                if (a == b || is_taken[tube.first.face] || is_taken[tube.second.face]) continue;
                if (n_joined == most) return n_joined;
                is_taken[tube.first.face] = is_taken[tube.second.face] = true;
                is_finished_[std::min(a, b)] = is_finished_[a] && is_finished_[b];
                label_[std::max(a, b)] = std::min(a, b);
                build(tube);
                ++n_joined;
            }
            if (n_joined == n_before) return n_joined;
        }
    }

  private:
    [[nodiscard]] std::uint32_t origin(std::uint32_t v) const {
        return v < mesh_.vertices.size() ? v : extra_[v - mesh_.vertices.size()];
    }
    [[nodiscard]] const Vec3& position(std::uint32_t v) const { return mesh_.position(origin(v)); }
    [[nodiscard]] bool has_face(std::uint32_t cluster) const {
        return component_of_cluster_[cluster] != kNoIndex;
    }

    std::uint32_t component(std::uint32_t v) {
        while (label_[v] != v) v = label_[v] = label_[label_[v]];
        return v;
    }

    /// Clusters that were neighbours and are not in one component.
    [[nodiscard]] std::vector<ClusterPair> find_pairs(std::span<const LocalFace> links) const {
        std::vector<ClusterPair> pairs;
        const auto add = [&](std::uint32_t a, std::uint32_t b) {
            if (is_shared_[a] || is_shared_[b] ||
                component_of_cluster_[a] != component_of_cluster_[b]) {
                pairs.emplace_back(std::min(a, b), std::max(a, b));
            }
        };
        for (std::uint32_t v = 0; v < is_shared_.size(); ++v) {
            if (is_shared_[v] && mesh_.vertices[v].n_cells > 1) add(v, v);
        }
        std::vector<LocalFace> among_faceless;
        for (const LocalFace& link : links) {
            const bool has_first = has_face(link[0]);
            const bool has_second = has_face(link[1]);
            if (has_first && has_second) add(link[0], link[1]);
            if (!has_first && !has_second) among_faceless.push_back(link);
        }
        const std::vector<std::uint32_t> group =
            component_labels(mesh_.vertices.size(), among_faceless);
        std::vector<ClusterPair> ends;  // group of clusters without a face, neighbour with faces
        for (const LocalFace& link : links) {
            const bool has_first = has_face(link[0]);
            if (has_first == has_face(link[1])) continue;
            ends.emplace_back(group[link[has_first ? 1 : 0]], link[has_first ? 0 : 1]);
        }
        std::sort(ends.begin(), ends.end());
        for (std::size_t i = 1, first = 0; i < ends.size(); ++i) {
            if (ends[i].first != ends[first].first) {
                first = i;
            } else {
                add(ends[first].second, ends[i].second);
            }
        }
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        return pairs;
    }

    /// The corners at the clusters of the pairs, those of a fan together.
    void find_corners(std::span<const ClusterPair> pairs) {
        std::vector<bool> is_wanted(mesh_.vertices.size());
        for (const auto& [a, b] : pairs) is_wanted[a] = is_wanted[b] = true;
        corners_.clear();
        for (std::uint32_t f = 0; f < named_.size(); ++f) {
            for (const std::uint32_t v : named_[f]) {
                if (is_wanted[origin(v)]) corners_.push_back({origin(v), v, f});
            }
        }
        std::sort(corners_.begin(), corners_.end(), [](const FanCorner& a, const FanCorner& b) {
            return std::tie(a.cluster, a.vertex, a.face) < std::tie(b.cluster, b.vertex, b.face);
        });
    }

    [[nodiscard]] std::vector<std::span<const FanCorner>> fans_of(std::uint32_t cluster) const {
        std::vector<std::span<const FanCorner>> fans;
        auto corner = std::lower_bound(
            corners_.begin(), corners_.end(), cluster,
            [](const FanCorner& c, std::uint32_t value) { return c.cluster < value; });
        while (corner != corners_.end() && corner->cluster == cluster) {
            const auto first = corner;
            while (corner != corners_.end() && corner->vertex == first->vertex) ++corner;
            fans.emplace_back(first, corner);
        }
        return fans;
    }

    /// The shortest tube between each two fans of a pair that are of different components, one of
    /// which is all here; shortest first.
    [[nodiscard]] std::vector<Tube> find_tubes(std::span<const ClusterPair> pairs) {
        std::vector<Tube> tubes;
        for (const auto& [a, b] : pairs) {
            for (const auto& first : fans_of(a)) {
                for (const auto& second : fans_of(b)) {
                    const std::uint32_t p = component(first[0].vertex);
                    const std::uint32_t q = component(second[0].vertex);
                    if (p == q || !(is_finished_[p] || is_finished_[q])) continue;
                    tubes.push_back(shortest_tube(first, second));
                }
            }
        }
        std::sort(tubes.begin(), tubes.end(), [](const Tube& a, const Tube& b) {
            return std::tie(a.length, a.first.vertex, a.second.vertex) <
                   std::tie(b.length, b.first.vertex, b.second.vertex);
        });
        return tubes;
    }

    [[nodiscard]] Tube shortest_tube(std::span<const FanCorner> first,
                                     std::span<const FanCorner> second) const {
        Tube best{-1, first[0], second[0]};
        for (const FanCorner& p : first) {
            for (const FanCorner& q : second) {
                const auto [v, a, b] = from(p);
                const auto [w, c, d] = from(q);
                double length = 0;
                for (const auto& [from, to] : {std::pair{v, w}, {a, d}, {b, c}}) {
                    const Vec3 side = position(to) - position(from);
                    length += dot(side, side);
                }
                if (best.length < 0 || length < best.length) best = {length, p, q};
            }
        }
        return best;
    }

    /// The corners of the face, the fan's vertex first.
    [[nodiscard]] LocalFace from(const FanCorner& corner) const {
        LocalFace t = named_[corner.face];
        std::rotate(t.begin(), std::find(t.begin(), t.end(), corner.vertex), t.end());
        return t;
    }

    void build(const Tube& tube) {
        const auto [v, a, b] = from(tube.first);
        const auto [w, c, d] = from(tube.second);
        named_[tube.first.face] = {v, a, d};
        named_[tube.second.face] = {w, c, b};
        named_.insert(named_.end(), {{v, d, w}, {a, b, c}, {a, c, d}, {b, v, w}});
    }

    const BlockMesh& mesh_;
    std::span<const std::uint32_t> extra_;
    std::vector<LocalFace>& named_;
    std::vector<std::uint32_t> label_;  // a tree: joined components have one root
    std::vector<bool> is_finished_;     // by root: all of its faces are here
    std::vector<std::uint32_t>
        component_of_cluster_;        // of its first fan; before anything is joined
    std::vector<bool> is_shared_;     // clusters of several components, likewise
    std::vector<FanCorner> corners_;  // of this round
};

}  // namespace

std::uint64_t join_necks(const BlockMesh& mesh, std::span<const std::uint32_t> extra,
                         std::span<const LocalFace> links, std::vector<LocalFace>& named) {
    return Necks(mesh, extra, named).join(links);
}

}  // namespace hewer::rsimp
