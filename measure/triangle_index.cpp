// SPDX-License-Identifier: MIT
#include "measure/triangle_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "measure/triangle_distance.h"
#include "measure/triangle_order.h"
#include "ooc/parallel.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kNodesPerTask = 1024;

std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) {
    return (a + b - 1) / b;
}

/// What box distances are compared with. They are computed in float from exact integer differences:
/// one rounding each for the conversion, the square and the sums, below 2^-21 of the result
/// together. The limit gets more than that.
HEWER_INLINE float with_slack(double squared_distance) {
    return static_cast<float>(squared_distance * (1.0 + 0x1p-20));
}

/// How far x is outside of [lo, hi].
HEWER_INLINE std::int32_t outside(std::int32_t lo, std::int32_t hi, std::int32_t x) {
    return std::max(std::max(lo - x, x - hi), 0);
}

/// Squared, from `p`, a point rounded to the lattice, to the box of `t` made a step wider for that.
HEWER_INLINE float triangle_box_distance(const LatticeTriangle& t, const LatticePoint& p) {
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t lo = std::min(std::min(t[0][k], t[1][k]), t[2][k]) - 1;
        const std::int32_t hi = std::max(std::max(t[0][k], t[1][k]), t[2][k]) + 1;
        const auto d = static_cast<float>(outside(lo, hi, p[k]));
        sum += d * d;
    }
    return sum;
}

/// Asks for the cache lines of what is likely to be read soon: a search in a large index spends a
/// quarter of its time waiting for them.
template <std::size_t kBytes>
HEWER_INLINE void prefetch(const void* address) {
    constexpr std::size_t kLine = 64;
    for (std::size_t i = 0; i < kBytes; i += kLine) {
        __builtin_prefetch(static_cast<const char*>(address) + i);
    }
}

}  // namespace

std::uint64_t TriangleIndex::n_nodes(std::uint64_t n) {
    std::uint64_t total = 0;
    std::uint64_t count = divide_up(n, kLeaf);
    do {
        count = divide_up(count, kFanOut);
        total += count;
    } while (count > 1);
    return total;
}

std::uint64_t TriangleIndex::bytes(std::uint64_t n) {
    return n * sizeof(LatticeTriangle) + n_nodes(n) * sizeof(Node);
}

TriangleIndex::TriangleIndex(ooc::Context& context, ooc::Array<LatticeTriangle> triangles,
                             std::uint64_t n)
    : triangles_(std::move(triangles)),
      nodes_(context.budget(), "index of triangles", n_nodes(n)),
      n_(n) {
    order_by_median_splits(context, triangles_.span().first(n), kLeaf);
    fill_boxes(context);
}

void TriangleIndex::fill_boxes(ooc::Context& context) {
    std::uint64_t first = 0;
    std::uint64_t n_children = divide_up(n_, kLeaf);
    do {
        levels_[n_levels_] = {first, n_children};
        const std::size_t level = n_levels_++;
        const std::uint64_t count = divide_up(n_children, kFanOut);
        context.workers().for_ranges(count, kNodesPerTask,
                                     [&](std::uint64_t begin, std::uint64_t end) {
                                         if (level == 0) {
                                             fill_leaf_parents(begin, end);
                                         } else {
                                             fill_inner_nodes(level, begin, end);
                                         }
                                     });
        first += count;
        n_children = count;
    } while (n_children > 1);
}

void TriangleIndex::fill_leaf_parents(std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
        Node& node = nodes_[i];
        const std::uint64_t n_children =
            std::min<std::uint64_t>(kFanOut, levels_[0].n_children - i * kFanOut);
        for (std::size_t c = 0; c < n_children; ++c) {
            const std::uint64_t leaf = i * kFanOut + c;
            const std::uint64_t last = std::min<std::uint64_t>(n_, (leaf + 1) * kLeaf);
            for (std::size_t k = 0; k < 3; ++k) {
                std::int32_t lo = std::numeric_limits<std::int32_t>::max();
                std::int32_t hi = std::numeric_limits<std::int32_t>::min();
                for (std::uint64_t t = leaf * kLeaf; t < last; ++t) {
                    for (const LatticePoint& p : triangles_[t]) {
                        lo = std::min(lo, p[k]);
                        hi = std::max(hi, p[k]);
                    }
                }
                // One step wider: the search rounds its point to the lattice.
                node.lo[k][c] = lo - 1;
                node.hi[k][c] = hi + 1;
            }
        }
    }
}

void TriangleIndex::fill_inner_nodes(std::size_t level, std::uint64_t begin, std::uint64_t end) {
    const Level& below = levels_[level - 1];
    for (std::uint64_t i = begin; i < end; ++i) {
        Node& node = nodes_[levels_[level].first + i];
        const std::uint64_t n_children =
            std::min<std::uint64_t>(kFanOut, levels_[level].n_children - i * kFanOut);
        for (std::size_t c = 0; c < n_children; ++c) {
            const std::uint64_t number = i * kFanOut + c;
            const Node& child = nodes_[below.first + number];
            const std::uint64_t n_grandchildren =
                std::min<std::uint64_t>(kFanOut, below.n_children - number * kFanOut);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& lo = child.lo[k];
                const auto& hi = child.hi[k];
                const auto n = static_cast<std::ptrdiff_t>(n_grandchildren);
                node.lo[k][c] = *std::min_element(lo.begin(), lo.begin() + n);
                node.hi[k][c] = *std::max_element(hi.begin(), hi.begin() + n);
            }
        }
    }
}

HEWER_INLINE std::array<float, TriangleIndex::kFanOut> TriangleIndex::child_distances(
    const Node& node, const LatticePoint& p) {
    std::array<float, kFanOut> d2;
    for (std::size_t c = 0; c < kFanOut; ++c) {
        float sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto d = static_cast<float>(outside(node.lo[k][c], node.hi[k][c], p[k]));
            sum += d * d;
        }
        d2[c] = sum;
    }
    return d2;
}

HEWER_INLINE void TriangleIndex::search_leaf(std::uint64_t leaf, const Vec3& q,
                                             const LatticePoint& p, Nearest& best,
                                             float& limit) const {
    const std::uint64_t end = std::min<std::uint64_t>(n_, (leaf + 1) * kLeaf);
    for (std::uint64_t t = leaf * kLeaf; t < end; ++t) {
        // Each triangle's own box spares many of the exact distances: a seventh of the time.
        if (triangle_box_distance(triangles_[t], p) > limit) continue;
        const double d = squared_distance(q, triangles_[t], best.squared_distance);
        if (d < best.squared_distance || (d == best.squared_distance && t < best.triangle)) {
            best = {d, t};
            limit = with_slack(d);
        }
    }
}

HEWER_VECTOR_CLONES TriangleIndex::Nearest TriangleIndex::nearest(const Vec3& q,
                                                                  std::uint64_t guess) const {
    Nearest best{squared_distance(q, triangles_[guess]), guess};
    float limit = with_slack(best.squared_distance);
    LatticePoint p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<std::int32_t>(std::lrint(q[k]));

    struct Visit {
        float squared_distance;
        std::uint32_t level;
        std::uint64_t number;  // within its level
    };
    std::array<Visit, kMaxLevels * kFanOut> stack;
    std::size_t n_stack = 0;
    stack[n_stack++] = {0, static_cast<std::uint32_t>(n_levels_ - 1), 0};
    while (n_stack > 0) {
        const Visit visit = stack[--n_stack];
        if (visit.squared_distance > limit) continue;
        const Level& level = levels_[visit.level];
        const std::array<float, kFanOut> d2 =
            child_distances(nodes_[level.first + visit.number], p);
        // Children within the limit, farthest first: so they go on the stack.
        const std::uint64_t first = visit.number * kFanOut;
        const std::uint64_t n_children = std::min<std::uint64_t>(kFanOut, level.n_children - first);
        std::array<std::pair<float, std::uint32_t>, kFanOut> near;
        std::size_t n_near = 0;
        for (std::uint32_t c = 0; c < n_children; ++c) {
            if (d2[c] > limit) continue;
            std::size_t i = n_near++;
            for (; i > 0 && near[i - 1].first < d2[c]; --i) near[i] = near[i - 1];
            near[i] = {d2[c], c};
            if (visit.level == 0) {
                prefetch<kLeaf * sizeof(LatticeTriangle)>(&triangles_[(first + c) * kLeaf]);
            } else {
                prefetch<sizeof(Node)>(&nodes_[levels_[visit.level - 1].first + first + c]);
            }
        }
        if (visit.level > 0) {
            for (std::size_t i = 0; i < n_near; ++i) {
                stack[n_stack++] = {near[i].first, visit.level - 1, first + near[i].second};
            }
        } else {
            for (std::size_t i = n_near; i-- > 0 && near[i].first <= limit;) {
                search_leaf(first + near[i].second, q, p, best, limit);
            }
        }
    }
    return best;
}

}  // namespace hewer::measuring
