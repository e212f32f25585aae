// SPDX-License-Identifier: MIT
#include "rsimp/face_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cluster/uniform_grid.h"
#include "ooc/vector_clones.h"

namespace hewer::rsimp {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Boxes farther than the best distance so far are left out; this allows for rounding, in part of it
// and of the square of a length of one.
constexpr float kSlack = 1.0001F;
constexpr std::size_t kMostLevels = 12;
// Points that share a walk through the tree.
constexpr std::size_t kGroup = 8;

std::uint32_t divide_up(std::size_t a, std::size_t b) {
    return static_cast<std::uint32_t>((a + b - 1) / b);
}

float reciprocal(float x) {
    return x > 0 ? 1 / x : 0;
}

}  // namespace

FaceTree::FaceTree(std::span<const Point3f> points, std::span<const LocalFace> faces) {
    Point3f low{kInfinity, kInfinity, kInfinity};
    Point3f high{-kInfinity, -kInfinity, -kInfinity};
    for (const Point3f& p : points) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    const float side = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-30F}) * 3;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> codes(faces.size());
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        std::uint64_t code = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const float sum =
                points[faces[f][0]][k] + points[faces[f][1]][k] + points[faces[f][2]][k];
            const float place = (sum - 3 * low[k]) / side * 65535;
            code |= cluster::spread_bits(static_cast<std::uint64_t>(std::max(place, 0.0F))) << k;
        }
        codes[f] = {code, f};
    }
    std::sort(codes.begin(), codes.end());
    order_.resize(faces.size());
    for (std::size_t s = 0; s < codes.size(); ++s) order_[s] = codes[s].second;
    leaves_.resize(divide_up(faces.size(), kLeaf));
    for (std::uint32_t leaf = 0; leaf < leaves_.size(); ++leaf) fill_leaf(leaf, points, faces);
    fill_nodes(points, faces);
}

void FaceTree::fill_leaf(std::uint32_t leaf, std::span<const Point3f> points,
                         std::span<const LocalFace> faces) {
    Leaf& l = leaves_[leaf];
    for (std::size_t i = 0; i < kLeaf; ++i) {
        // An incomplete leaf repeats its last face.
        const std::size_t slot = std::min(leaf * kLeaf + i, order_.size() - 1);
        const LocalFace& face = faces[order_[slot]];
        float bc_bc = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            l.a[k][i] = points[face[0]][k];
            l.ab[k][i] = points[face[1]][k] - l.a[k][i];
            l.ac[k][i] = points[face[2]][k] - l.a[k][i];
            l.ab_ab[i] += l.ab[k][i] * l.ab[k][i];
            l.ab_ac[i] += l.ab[k][i] * l.ac[k][i];
            l.ac_ac[i] += l.ac[k][i] * l.ac[k][i];
            const float bc = l.ac[k][i] - l.ab[k][i];
            bc_bc += bc * bc;
        }
        const float det = l.ab_ab[i] * l.ac_ac[i] - l.ab_ac[i] * l.ab_ac[i];
        // Needles count as their edges.
        l.per_det[i] = det > 1e-5F * l.ab_ab[i] * l.ac_ac[i] ? 1 / det : 0;
        l.per_ab[i] = reciprocal(l.ab_ab[i]);
        l.per_ac[i] = reciprocal(l.ac_ac[i]);
        l.per_bc[i] = reciprocal(bc_bc);
    }
}

void FaceTree::fill_nodes(std::span<const Point3f> points, std::span<const LocalFace> faces) {
    std::size_t n_children = leaves_.size();
    std::size_t below = 0;
    do {
        const auto first = static_cast<std::uint32_t>(nodes_.size());
        const std::size_t n = divide_up(n_children, kFanOut);
        for (std::size_t parent = 0; parent < n; ++parent) {
            Node node;
            for (std::size_t k = 0; k < 3; ++k) {
                node.low[k] = Lanes{} + kInfinity;  // an absent child is infinitely far
                node.high[k] = Lanes{} - kInfinity;
            }
            for (std::size_t c = 0; c < std::min(kFanOut, n_children - parent * kFanOut); ++c) {
                const std::size_t child = parent * kFanOut + c;
                for (std::size_t k = 0; k < 3; ++k) {
                    float low = kInfinity;
                    float high = -kInfinity;
                    if (levels_.empty()) {
                        const std::size_t end = std::min((child + 1) * kLeaf, order_.size());
                        for (std::size_t s = child * kLeaf; s < end; ++s) {
                            for (const std::uint32_t v : faces[order_[s]]) {
                                low = std::min(low, points[v][k]);
                                high = std::max(high, points[v][k]);
                            }
                        }
                    } else {
                        const Node& under = nodes_[below + child];
                        for (std::size_t i = 0; i < kFanOut; ++i) {
                            low = std::min(low, under.low[k][i]);
                            high = std::max(high, under.high[k][i]);
                        }
                    }
                    node.low[k][c] = low;
                    node.high[k][c] = high;
                }
            }
            nodes_.push_back(node);
        }
        levels_.push_back({first, static_cast<std::uint32_t>(n_children)});
        below = first;
        n_children = n;
    } while (n_children > 1);
}

/// To the plane where the point is over the triangle, else to the nearest of the edges.
HEWER_INLINE void FaceTree::distances_to_leaf(const Leaf& leaf, const Point3f& p, Lanes& squared) {
    const Lanes zero{};
    const Lanes one = zero + 1;
    const Lanes x = p[0] - leaf.a[0];
    const Lanes y = p[1] - leaf.a[1];
    const Lanes z = p[2] - leaf.a[2];
    const Lanes along_b = x * leaf.ab[0] + y * leaf.ab[1] + z * leaf.ab[2];
    const Lanes along_c = x * leaf.ac[0] + y * leaf.ac[1] + z * leaf.ac[2];
    const auto measure = [&](const Lanes& v, const Lanes& w, Lanes& result) {
        const Lanes dx = x - v * leaf.ab[0] - w * leaf.ac[0];
        const Lanes dy = y - v * leaf.ab[1] - w * leaf.ac[1];
        const Lanes dz = z - v * leaf.ab[2] - w * leaf.ac[2];
        result = dx * dx + dy * dy + dz * dz;
    };
    const auto clamp = [&](Lanes& t) {
        t = t < zero ? zero : t;
        t = t > one ? one : t;
    };
    const Lanes v = (leaf.ac_ac * along_b - leaf.ab_ac * along_c) * leaf.per_det;
    const Lanes w = (leaf.ab_ab * along_c - leaf.ab_ac * along_b) * leaf.per_det;
    Lanes to_plane;
    measure(v, w, to_plane);
    Lanes t = along_b * leaf.per_ab;
    clamp(t);
    Lanes best;
    measure(t, zero, best);
    t = along_c * leaf.per_ac;
    clamp(t);
    Lanes other;
    measure(zero, t, other);
    best = other < best ? other : best;
    t = ((along_c - along_b) - (leaf.ab_ac - leaf.ab_ab)) * leaf.per_bc;
    clamp(t);
    measure(one - t, t, other);
    best = other < best ? other : best;
    // A needle (no determinant) counts as its edges.
    const auto is_over = (leaf.per_det > zero) & (v >= zero) & (w >= zero) & (v + w <= one);
    squared = is_over ? to_plane : best;
}

HEWER_INLINE void FaceTree::distances_to_node(const Node& node, const Point3f& p, Lanes& squared) {
    const Lanes zero{};
    Lanes sum = zero;
    for (std::size_t k = 0; k < 3; ++k) {
        const Lanes under = node.low[k] - p[k];
        const Lanes over = p[k] - node.high[k];
        Lanes outside = under > over ? under : over;
        outside = outside > zero ? outside : zero;
        sum += outside * outside;
    }
    squared = sum;
}

HEWER_INLINE void FaceTree::search_leaf(std::uint32_t leaf, const Point3f& p, Hit& best) const {
    Lanes squared;
    distances_to_leaf(leaves_[leaf], p, squared);
    for (std::size_t i = 0; i < kLeaf; ++i) {
        if (!(squared[i] <= best.squared_distance)) continue;
        const auto slot =
            static_cast<std::uint32_t>(std::min<std::size_t>(leaf * kLeaf + i, order_.size() - 1));
        // Of several at one distance the one that comes first, so that the guess does not matter.
        if (squared[i] == best.squared_distance && slot >= best.slot) continue;
        best = {squared[i], slot, order_[slot]};
    }
}

HEWER_VECTOR_CLONES FaceTree::Hit FaceTree::nearest(const Point3f& p, float most,
                                                    std::uint32_t guess) const {
    Hit best{most, kNone, kNone};
    search_leaf(static_cast<std::uint32_t>(guess / kLeaf), p, best);
    struct Entry {
        float squared;
        std::uint32_t level;
        std::uint32_t node;  // within the level
    };
    std::array<Entry, kMostLevels * kFanOut> stack;
    std::size_t n = 0;
    stack[n++] = {0, static_cast<std::uint32_t>(levels_.size() - 1), 0};
    while (n > 0) {
        const Entry entry = stack[--n];
        if (entry.squared > best.squared_distance * kSlack) continue;
        const Level& level = levels_[entry.level];
        Lanes squared;
        distances_to_node(nodes_[level.first + entry.node], p, squared);
        // The nearest child goes on top.
        const std::size_t begin = n;
        for (std::uint32_t c = 0; c < kFanOut; ++c) {
            if (squared[c] > best.squared_distance * kSlack || squared[c] == kInfinity) continue;
            const Entry child{squared[c], entry.level,
                              static_cast<std::uint32_t>(entry.node * kFanOut + c)};
            std::size_t i = n++;
            for (; i > begin && stack[i - 1].squared < child.squared; --i) stack[i] = stack[i - 1];
            stack[i] = child;
        }
        if (entry.level > 0) {
            for (std::size_t i = begin; i < n; ++i) --stack[i].level;
            continue;
        }
        while (n > begin) {
            const Entry leaf = stack[--n];
            if (leaf.squared > best.squared_distance * kSlack) continue;
            search_leaf(leaf.node, p, best);
        }
    }
    return best;
}

/// All leaves whose boxes are within `distance`.
HEWER_VECTOR_CLONES void FaceTree::leaves_within(const Point3f& p, float distance,
                                                 NearLeaves& near) const {
    const float most = distance * distance;
    struct Entry {
        std::uint32_t level;
        std::uint32_t node;
    };
    std::array<Entry, kMostLevels * kFanOut> stack;
    std::size_t n = 0;
    near.n = 0;
    stack[n++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
    while (n > 0) {
        const Entry entry = stack[--n];
        const Node& node = nodes_[levels_[entry.level].first + entry.node];
        Lanes squared;
        distances_to_node(node, p, squared);
        for (std::uint32_t c = 0; c < kFanOut; ++c) {
            if (!(squared[c] <= most)) continue;
            const auto child = static_cast<std::uint32_t>(entry.node * kFanOut + c);
            if (entry.level > 0) {
                stack[n++] = {entry.level - 1, child};
                continue;
            }
            const std::size_t i = near.n++;
            if (i == kMostNear) return;
            near.leaves[i] = child;
            Node& box = near.boxes[i / kFanOut];
            for (std::size_t k = 0; k < 3; ++k) {
                box.low[k][i % kFanOut] = node.low[k][c];
                box.high[k][i % kFanOut] = node.high[k][c];
            }
        }
    }
}

/// Boxes tell more about one point than what they are from the centre of a group: with the bound
/// that the guess gives, three of some fifteen leaves are left.
HEWER_INLINE void FaceTree::search_near(const NearLeaves& near, const Point3f& p,
                                        std::uint32_t guess, Hit& best) const {
    const auto first_leaf = static_cast<std::uint32_t>(guess / kLeaf);
    search_leaf(first_leaf, p, best);
    for (std::size_t first = 0; first < near.n; first += kFanOut) {
        Lanes squared;
        distances_to_node(near.boxes[first / kFanOut], p, squared);
        const std::size_t n = std::min(kFanOut, near.n - first);
        for (std::size_t i = 0; i < n; ++i) {
            if (squared[i] > best.squared_distance * kSlack) continue;
            if (near.leaves[first + i] != first_leaf) search_leaf(near.leaves[first + i], p, best);
        }
    }
}

/// False if the points are too far apart for a common walk.
HEWER_VECTOR_CLONES bool FaceTree::nearest_of_group(std::span<const Point3f> group, float most,
                                                    std::uint32_t guess, Hit* hits) const {
    Point3f low = group[0];
    Point3f high = group[0];
    for (const Point3f& p : group) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    Point3f centre;
    for (std::size_t k = 0; k < 3; ++k) centre[k] = 0.5F * (low[k] + high[k]);
    float radius = 0;
    for (const Point3f& p : group) {
        float sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const float d = p[k] - centre[k];
            sum += d * d;
        }
        radius = std::max(radius, std::sqrt(sum));
    }
    // What is nearest to a point is at most two radii farther from the centre than what is nearest
    // to the centre.
    Hit near_centre{kInfinity, kNone, kNone};
    search_leaf(static_cast<std::uint32_t>(guess / kLeaf), centre, near_centre);
    const float reach =
        std::min(std::sqrt(near_centre.squared_distance) + 2 * radius, std::sqrt(most) + radius);
    NearLeaves near{};
    leaves_within(centre, reach * kSlack, near);
    if (near.n > kMostNear) return false;
    for (std::size_t i = 0; i < group.size(); ++i) {
        Hit best{most, kNone, kNone};
        search_near(near, group[i], guess, best);
        if (best.face != kNone) guess = best.slot;
        hits[i] = best;
    }
    return true;
}

void FaceTree::nearest(std::span<const Point3f> points, float most, std::uint32_t& guess,
                       std::span<Hit> hits) const {
    for (std::size_t first = 0; first < points.size(); first += kGroup) {
        const std::size_t last = std::min(points.size(), first + kGroup);
        if (!nearest_of_group(points.subspan(first, last - first), most, guess, &hits[first])) {
            for (std::size_t i = first; i < last; ++i) {
                hits[i] = nearest(points[i], most, guess);
                if (hits[i].face != kNone) guess = hits[i].slot;
            }
        } else if (hits[last - 1].face != kNone) {
            guess = hits[last - 1].slot;
        }
    }
}

}  // namespace hewer::rsimp
