// SPDX-License-Identifier: MIT
/// How far the border of a simplified mesh is from the border of the original, and whether holes
/// appeared: an independent judge, nothing of the product is linked in.
///
///     border_check ORIGINAL.ply SIMPLIFIED.ply
///
/// A border edge has one face; vertices at equal positions are one. Points at equal distances along
/// one border, vertices included, are measured to the nearest point of the other border. A loop is
/// a connected set of border edges. Prints JSON: edges, loops and length of both, and RMS and
/// maximum of the distances both ways (null where a border is missing), model units.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/plain_ply.h"

namespace {

using Point = std::array<double, 3>;
using nlohmann::ordered_json;

constexpr std::size_t kSamples = 200'000;

struct Segment {
    Point a{};
    Point b{};
};

struct Border {
    std::vector<Segment> segments;
    std::size_t n_loops = 0;
    double length = 0;
};

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Point between(const Segment& s, double t) {
    const Point d = minus(s.b, s.a);
    return {s.a[0] + t * d[0], s.a[1] + t * d[1], s.a[2] + t * d[2]};
}

double distance_sq(const Point& p, const Segment& s) {
    const Point along = minus(s.b, s.a);
    const double length_sq = dot(along, along);
    const double t =
        length_sq > 0 ? std::clamp(dot(minus(p, s.a), along) / length_sq, 0.0, 1.0) : 0.0;
    const Point off = minus(p, between(s, t));
    return dot(off, off);
}

Border find_border(const bench::PlainMesh& mesh) {
    const auto position = [&](std::uint32_t v) {
        const float* p = &mesh.positions[std::size_t{3} * v];
        return Point{p[0], p[1], p[2]};
    };
    std::vector<std::uint32_t> order(mesh.positions.size() / 3);
    std::iota(order.begin(), order.end(), std::uint32_t{0});
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(position(a), a) < std::pair(position(b), b);
    });
    std::vector<std::uint32_t> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool is_repeat = i > 0 && position(order[i]) == position(order[i - 1]);
        first[order[i]] = is_repeat ? first[order[i - 1]] : order[i];
    }

    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::array<std::uint32_t, 3> f{};
        for (std::size_t c = 0; c < 3; ++c) f[c] = first[mesh.indices[t + c]];
        if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;
        for (std::size_t c = 0; c < 3; ++c) edges.push_back(std::minmax({f[c], f[(c + 1) % 3]}));
    }
    std::sort(edges.begin(), edges.end());

    Border border;
    std::vector<std::uint32_t> parent(first.size());
    std::iota(parent.begin(), parent.end(), std::uint32_t{0});
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    std::vector<bool> is_seen(first.size(), false);
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        for (next = i; next < edges.size() && edges[next] == edges[i];) ++next;
        if (next - i != 1) continue;
        const auto [a, b] = edges[i];
        border.segments.push_back({position(a), position(b)});
        const Point along = minus(position(b), position(a));
        border.length += std::sqrt(dot(along, along));
        for (const std::uint32_t v : {a, b}) {
            if (!is_seen[v]) ++border.n_loops;
            is_seen[v] = true;
        }
        if (root(a) != root(b)) --border.n_loops;
        parent[root(a)] = root(b);
    }
    return border;
}

/// Nearest of a set of segments: a tree of boxes over them, split at the middle of the longest
/// side's order.
class SegmentTree {
  public:
    explicit SegmentTree(std::vector<Segment> segments) : segments_(std::move(segments)) {
        build(0, 0, segments_.size());
    }

    [[nodiscard]] double nearest_sq(const Point& p) const {
        double best = std::numeric_limits<double>::infinity();
        search(0, 0, segments_.size(), p, best);
        return best;
    }

  private:
    static constexpr std::size_t kLeaf = 4;

    struct Box {
        Point low{};
        Point high{};
    };

    void build(std::size_t node, std::size_t begin, std::size_t end) {
        if (node >= boxes_.size()) boxes_.resize(2 * node + 2);
        constexpr double kFar = std::numeric_limits<double>::infinity();
        Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                box.low[k] = std::min({box.low[k], segments_[i].a[k], segments_[i].b[k]});
                box.high[k] = std::max({box.high[k], segments_[i].a[k], segments_[i].b[k]});
            }
        }
        boxes_[node] = box;
        if (end - begin <= kLeaf) return;
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k) {
            if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
        }
        const auto at = [this](std::size_t i) {
            return segments_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        const std::size_t middle = begin + (end - begin) / 2;
        std::nth_element(at(begin), at(middle), at(end), [&](const Segment& s, const Segment& t) {
            return s.a[axis] + s.b[axis] < t.a[axis] + t.b[axis];
        });
        build(2 * node + 1, begin, middle);
        build(2 * node + 2, middle, end);
    }

    [[nodiscard]] double box_distance_sq(std::size_t node, const Point& p) const {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double off =
                std::max({boxes_[node].low[k] - p[k], 0.0, p[k] - boxes_[node].high[k]});
            sum += off * off;
        }
        return sum;
    }

    void search(std::size_t node, std::size_t begin, std::size_t end, const Point& p,
                double& best) const {
        if (end - begin <= kLeaf) {
            for (std::size_t i = begin; i < end; ++i) {
                best = std::min(best, distance_sq(p, segments_[i]));
            }
            return;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        const double left = box_distance_sq(2 * node + 1, p);
        const double right = box_distance_sq(2 * node + 2, p);
        const bool is_left_first = left <= right;
        for (const bool is_left : {is_left_first, !is_left_first}) {
            if ((is_left ? left : right) >= best) continue;
            if (is_left) search(2 * node + 1, begin, middle, p, best);
            if (!is_left) search(2 * node + 2, middle, end, p, best);
        }
    }

    std::vector<Segment> segments_;
    std::vector<Box> boxes_;
};

ordered_json distances(const Border& from, const Border& to) {
    if (from.segments.empty() || to.segments.empty()) return nullptr;
    const SegmentTree tree(to.segments);
    const double step = from.length / kSamples;
    double sum = 0;
    double worst_sq = 0;
    for (const Segment& s : from.segments) {
        const Point along = minus(s.b, s.a);
        const double length = std::sqrt(dot(along, along));
        const double n = std::max(1.0, std::ceil(length / step));
        for (double i = 0; i < n; ++i) {
            const double d = tree.nearest_sq(between(s, (i + 0.5) / n));
            sum += d * length / n;
            worst_sq = std::max(worst_sq, d);
        }
        worst_sq = std::max({worst_sq, tree.nearest_sq(s.a), tree.nearest_sq(s.b)});
    }
    return {{"rms", std::sqrt(sum / from.length)}, {"maximum", std::sqrt(worst_sq)}};
}

ordered_json describe(const Border& border) {
    return {
        {"edges", border.segments.size()}, {"loops", border.n_loops}, {"length", border.length}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: border_check ORIGINAL.ply SIMPLIFIED.ply\n", stderr);
        return 2;
    }
    try {
        const Border original = find_border(bench::read_plain_ply(argv[1]));
        const Border simplified = find_border(bench::read_plain_ply(argv[2]));
        const ordered_json report{{"original", describe(original)},
                                  {"simplified", describe(simplified)},
                                  {"forward", distances(original, simplified)},
                                  {"backward", distances(simplified, original)}};
        std::puts(report.dump(2).c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "border_check: %s\n", error.what());
        return 1;
    }
    return 0;
}
