// SPDX-License-Identifier: MIT
/// How far the border of a simplified mesh is from the border of the original, and whether holes
/// appeared: an independent judge, nothing of the product is linked in.
///
///     border_check ORIGINAL.ply SIMPLIFIED.ply
///
/// A border edge has one face; vertices at equal positions are one. A loop goes from border edge to
/// border edge around the faces between them: sheets that merely touch in a vertex have loops of
/// their own, whether or not they share it.
///
/// Points at equal distances along one border, vertices included, are measured to the nearest point
/// of the other. One exception: a loop of the original is closed if the simplified border has no
/// point that it would be nearest to. The distance to some other hole says nothing about it then,
/// and its points count with what closing moves a border at most, the width of the hole: 2 area /
/// length, the area being that of the triangles between its edges and its centre. That is the
/// radius of a circle, the inner radius of a triangle, the width of a slit; of a bent slit more.
///
/// Prints JSON: edges, loops and length of both, how many loops are closed and their length, and
/// RMS and maximum of the distances both ways (null where a border is missing), model units.
#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/disjoint_sets.h"
#include "tests/bench/plain_ply.h"

namespace {

using Point = std::array<double, 3>;
using nlohmann::ordered_json;

constexpr std::size_t kSamples = 200'000;

struct Segment {
    Point a{};
    Point b{};
    std::uint32_t loop = 0;
};

struct Loop {
    double length = 0;
    double width = 0;
    bool is_closed = false;
};

struct Border {
    std::vector<Segment> segments;
    std::vector<Loop> loops;
    double length = 0;
};

struct Edge {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    std::uint32_t face = 0;

    [[nodiscard]] bool is_same(const Edge& other) const {
        return low == other.low && high == other.high;
    }
    auto operator<=>(const Edge&) const = default;
};

/// Disjoint sets of things with numbers.
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

double length_of(const Segment& s) {
    const Point along = minus(s.b, s.a);
    return std::sqrt(dot(along, along));
}

double area_between(const Segment& s, const Point& centre) {
    const Point a = minus(s.a, centre);
    const Point b = minus(s.b, centre);
    const double ab = dot(a, b);
    return 0.5 * std::sqrt(std::max(0.0, dot(a, a) * dot(b, b) - ab * ab));
}

void measure_loops(Border& border) {
    std::vector<Point> centres(border.loops.size());
    for (const Segment& s : border.segments) {
        const double length = length_of(s);
        border.loops[s.loop].length += length;
        border.length += length;
        for (std::size_t k = 0; k < 3; ++k) {
            centres[s.loop][k] += 0.5 * length * (s.a[k] + s.b[k]);
        }
    }
    for (std::size_t i = 0; i < centres.size(); ++i) {
        for (double& x : centres[i]) x /= border.loops[i].length;
    }
    for (const Segment& s : border.segments) {
        Loop& loop = border.loops[s.loop];
        loop.width += 2 * area_between(s, centres[s.loop]) / loop.length;
    }
}

Border find_border(const bench::PlainMesh& mesh) {
    const std::vector<std::uint32_t> first = bench::first_at_position(mesh);
    std::vector<std::array<std::uint32_t, 3>> faces;
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::array<std::uint32_t, 3> f{};
        for (std::size_t c = 0; c < 3; ++c) f[c] = first[mesh.indices[t + c]];
        if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax(f[c], f[(c + 1) % 3]);
            edges.push_back({low, high, static_cast<std::uint32_t>(faces.size())});
        }
        faces.push_back(f);
    }
    std::sort(edges.begin(), edges.end());

    // Corners of faces are joined over the edges between the faces: what is one then is a fan.
    const auto corner = [&](std::uint32_t face, std::uint32_t vertex) {
        const auto& f = faces[face];
        return 3 * face + (f[0] == vertex ? 0U : (f[1] == vertex ? 1U : 2U));
    };
    bench::DisjointSets fans(3 * faces.size());
    std::vector<Edge> open;
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        for (next = i + 1; next < edges.size() && edges[next].is_same(edges[i]); ++next) {
            for (const std::uint32_t v : {edges[i].low, edges[i].high}) {
                fans.join(corner(edges[i].face, v), corner(edges[next].face, v));
            }
        }
        if (next - i == 1) open.push_back(edges[i]);
    }
    bench::DisjointSets loops(open.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  // fan, border edge
    for (std::uint32_t i = 0; i < open.size(); ++i) {
        for (const std::uint32_t v : {open[i].low, open[i].high}) {
            ends.emplace_back(fans.root(corner(open[i].face, v)), i);
        }
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
        if (ends[i].first == ends[i - 1].first) loops.join(ends[i].second, ends[i - 1].second);
    }

    Border border;
    const auto position = [&](std::uint32_t v) {
        const float* p = &mesh.positions[std::size_t{3} * v];
        return Point{p[0], p[1], p[2]};
    };
    std::vector<std::uint32_t> number(open.size(), 0);
    for (std::uint32_t i = 0; i < open.size(); ++i) {
        if (loops.root(i) != i) continue;
        number[i] = static_cast<std::uint32_t>(border.loops.size());
        border.loops.emplace_back();
    }
    for (std::uint32_t i = 0; i < open.size(); ++i) {
        border.segments.push_back(
            {position(open[i].low), position(open[i].high), number[loops.root(i)]});
    }
    measure_loops(border);
    return border;
}

/// Nearest of a set of segments: a tree of boxes over them, split at the middle of the longest
/// side's order.
class SegmentTree {
  public:
    explicit SegmentTree(std::vector<Segment> segments) : segments_(std::move(segments)) {
        build(0, 0, segments_.size());
    }

    struct Hit {
        double squared = std::numeric_limits<double>::infinity();
        std::uint32_t loop = 0;
    };
    [[nodiscard]] Hit nearest(const Point& p) const {
        Hit best;
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
                Hit& best) const {
        if (end - begin <= kLeaf) {
            for (std::size_t i = begin; i < end; ++i) {
                const double squared = distance_sq(p, segments_[i]);
                if (squared < best.squared) best = {squared, segments_[i].loop};
            }
            return;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        const double left = box_distance_sq(2 * node + 1, p);
        const double right = box_distance_sq(2 * node + 2, p);
        const bool is_left_first = left <= right;
        for (const bool is_left : {is_left_first, !is_left_first}) {
            if ((is_left ? left : right) >= best.squared) continue;
            if (is_left) search(2 * node + 1, begin, middle, p, best);
            if (!is_left) search(2 * node + 2, middle, end, p, best);
        }
    }

    std::vector<Segment> segments_;
    std::vector<Box> boxes_;
};

/// Calls visit(point, its share of the length, loop) for points along a border; ends of edges count
/// nothing.
template <typename Visit>
void for_each_point(const Border& border, const Visit& visit) {
    const double step = border.length / kSamples;
    for (const Segment& s : border.segments) {
        const double length = length_of(s);
        const double n = std::max(1.0, std::ceil(length / step));
        for (double i = 0; i < n; ++i) visit(between(s, (i + 0.5) / n), length / n, s.loop);
        visit(s.a, 0.0, s.loop);
        visit(s.b, 0.0, s.loop);
    }
}

/// Marks the loops of the original that no point of the simplified border belongs to.
void find_closed_loops(Border& original, const Border& simplified) {
    for (Loop& loop : original.loops) loop.is_closed = true;
    const SegmentTree tree(original.segments);
    for_each_point(simplified, [&](const Point& p, double, std::uint32_t) {
        original.loops[tree.nearest(p).loop].is_closed = false;
    });
}

ordered_json distances(const Border& from, const Border& to) {
    if (from.segments.empty() || to.segments.empty()) return nullptr;
    const SegmentTree tree(to.segments);
    double sum = 0;
    double worst_sq = 0;
    for_each_point(from, [&](const Point& p, double share, std::uint32_t loop) {
        double squared = tree.nearest(p).squared;
        const Loop& own = from.loops[loop];
        if (own.is_closed) squared = std::min(squared, own.width * own.width);
        sum += squared * share;
        worst_sq = std::max(worst_sq, squared);
    });
    return {{"rms", std::sqrt(sum / from.length)}, {"maximum", std::sqrt(worst_sq)}};
}

ordered_json describe(const Border& border) {
    return {{"edges", border.segments.size()},
            {"loops", border.loops.size()},
            {"length", border.length}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: border_check ORIGINAL.ply SIMPLIFIED.ply\n", stderr);
        return 2;
    }
    try {
        Border original = find_border(bench::read_plain_ply(argv[1]));
        const Border simplified = find_border(bench::read_plain_ply(argv[2]));
        if (!original.segments.empty() && !simplified.segments.empty()) {
            find_closed_loops(original, simplified);
        }
        std::size_t n_closed = 0;
        double closed_length = 0;
        for (const Loop& loop : original.loops) {
            if (!loop.is_closed) continue;
            ++n_closed;
            closed_length += loop.length;
        }
        const ordered_json report{{"original", describe(original)},
                                  {"simplified", describe(simplified)},
                                  {"closed", {{"loops", n_closed}, {"length", closed_length}}},
                                  {"forward", distances(original, simplified)},
                                  {"backward", distances(simplified, original)}};
        std::puts(report.dump(2).c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "border_check: %s\n", error.what());
        return 1;
    }
    return 0;
}
