// SPDX-License-Identifier: MIT
#include "measure/waiting_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "measure/triangle_distance.h"
#include "measure/triangle_index.h"
#include "ooc/parallel.h"
#include "ooc/vector_clones.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kLeavesPerTask = 1024;
constexpr std::uint64_t kNodesPerTask = 1024;
// Triangles that are looked up together, and how much larger than one of them all may be together.
constexpr std::size_t kMostTogether = 32;
constexpr std::int64_t kMostSpread = 24;
// Levels of 8: enough for 2^63 leaves, with all children of one path on the stack.
constexpr std::size_t kMostVisits = 22 * 8;
// Occupied cells of the grid are about one in so many slots.
constexpr double kSlotsPerCell = 2;
// What is left of a coordinate in a packed point.
constexpr unsigned kPackedBits = 21;
constexpr unsigned kDroppedBits = 31 - kPackedBits;
constexpr std::uint64_t kHalfDropped = (1U << kDroppedBits) / 2;

constexpr std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) {
    return (a + b - 1) / b;
}

/// As in TriangleIndex: what box distances in float are compared with.
HEWER_INLINE float with_slack(double squared_distance) {
    return static_cast<float>(squared_distance * (1.0 + 0x1p-20));
}

template <typename T>
void lower_to(T& least, T value) {
    const std::atomic_ref<T> ref(least);
    T now = ref.load(std::memory_order_relaxed);
    while (value < now && !ref.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
}

LatticePoint rounded(const Vec3& q) {
    LatticePoint p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<std::int32_t>(std::lrint(q[k]));
    return p;
}

/// The largest of a leaf's or a node's limits; they may be lowered at the same time.
HEWER_INLINE float largest(std::array<float, 8>& limits) {
    float most = -1;
    for (float& limit : limits) {
        most = std::max(most, std::atomic_ref(limit).load(std::memory_order_relaxed));
    }
    return most;
}

}  // namespace

std::uint64_t WaitingPoints::n_slots(std::uint64_t n) {
    return std::bit_ceil(std::max<std::uint64_t>(n, 1024));
}

std::uint64_t WaitingPoints::n_nodes(std::uint64_t n) {
    std::uint64_t total = 0;
    std::uint64_t count = divide_up(n, kLeaf);
    do {
        count = divide_up(count, kFanOut);
        total += count;
    } while (count > 1);
    return total;
}

std::uint64_t WaitingPoints::bytes(std::uint64_t n) {
    return n * (sizeof(Vec3) + sizeof(double)) + divide_up(n, kLeaf) * sizeof(Leaf) +
           n_nodes(n) * sizeof(Node) + n_slots(n) * sizeof(std::uint64_t);
}

/// 21 bits an axis, and one that tells a point from none.
std::uint64_t WaitingPoints::pack(const LatticePoint& p) {
    std::uint64_t word = 1;
    for (const std::int32_t x : p) {
        const auto positive = static_cast<std::uint64_t>(std::int64_t{x} + (kLatticeRadius + 1));
        word = word << kPackedBits | positive >> kDroppedBits;
    }
    return word;
}

Vec3 WaitingPoints::unpack(std::uint64_t word) {
    Vec3 p{};
    for (std::size_t k = 3; k-- > 0;) {
        const std::uint64_t x = (word & ((1U << kPackedBits) - 1)) << kDroppedBits;
        p[k] = static_cast<double>(x + kHalfDropped) - (kLatticeRadius + 1.0);
        word >>= kPackedBits;
    }
    return p;
}

void WaitingPoints::make_arrays(ooc::Context& context) {
    best_ = {context.budget(), "distances", points_.size()};
    leaves_ = {context.budget(), "points that wait", divide_up(points_.size(), kLeaf)};
    nodes_ = {context.budget(), "tree of points that wait", n_nodes(points_.size())};
    std::fill(best_.begin(), best_.end(), std::numeric_limits<double>::infinity());
}

WaitingPoints::WaitingPoints(ooc::Context& context, ooc::Array<Vec3> points, double area)
    : points_(std::move(points)) {
    make_arrays(context);
    grid_ = {context.budget(), "grid of limits", n_slots(points_.size())};
    const double cell = std::sqrt(area * kSlotsPerCell / static_cast<double>(grid_.size()));
    cell_bits_ = std::clamp(static_cast<int>(std::ceil(std::log2(std::max(cell, 1.0)))), 8, 30);
}

WaitingPoints::WaitingPoints(ooc::Context& context, ooc::Array<Piece> pieces, double enough)
    : points_(context.budget(), "centers of pieces", pieces.size()),
      pieces_(std::move(pieces)),
      nearest_(context.budget(), "triangles near to pieces", points_.size()),
      enough_(enough),
      locks_(std::make_unique<std::array<std::mutex, kLocks>>()) {
    std::transform(pieces_.begin(), pieces_.end(), points_.begin(), center_of);
    make_arrays(context);
    std::array<double, kLeaf> limits;
    limits.fill(std::sqrt(enough));
    for (std::uint64_t l = 0; l < leaves_.size(); ++l) {
        fill_leaf(l, std::span(limits).first(std::min<std::uint64_t>(kLeaf, size() - l * kLeaf)));
    }
    fill_nodes(context);
}

/// To one of the noted points near `p`, rounded up; infinity if there is none.
double WaitingPoints::distance_to_noted(const LatticePoint& p) const {
    double least = std::numeric_limits<double>::infinity();
    const Vec3 q = to_double(p);
    const Cell center = cell_of(p);
    for (int i = 0; i < 27; ++i) {
        const Cell cell{center[0] + i % 3 - 1, center[1] + i / 3 % 3 - 1, center[2] + i / 9 - 1};
        const std::uint64_t word = grid_[slot_of(cell)];
        if (word == 0) continue;
        const Vec3 d = detail::minus(q, unpack(word));
        least = std::min(least, detail::dot(d, d));
    }
    // Half the diagonal of what was dropped, sqrt(3) * 2^(kDroppedBits - 1), and the rounding of p.
    return std::sqrt(least) + (1U << kDroppedBits);
}

void WaitingPoints::fill_leaf(std::uint64_t l, std::span<const double> limits) {
    Leaf& leaf = leaves_[l];
    leaf.limit.fill(-1);  // nothing is that near: for what is not there
    for (std::size_t i = 0; i < limits.size(); ++i) {
        const LatticePoint p = rounded(points_[l * kLeaf + i]);
        for (std::size_t k = 0; k < 3; ++k) leaf.at[k][i] = p[k];
        leaf.limit[i] = with_slack(limits[i] * limits[i]);
    }
}

WaitingPoints::Box WaitingPoints::box_of_leaf(std::uint64_t l) {
    Leaf& leaf = leaves_[l];
    Box box{{}, {}, largest(leaf.limit)};
    const std::uint64_t n = std::min<std::uint64_t>(kLeaf, size() - l * kLeaf);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [lo, hi] = std::minmax_element(leaf.at[k].begin(), leaf.at[k].begin() + n);
        box.lo[k] = *lo;
        box.hi[k] = *hi;
    }
    return box;
}

WaitingPoints::Box WaitingPoints::box_of_node(Node& node) {
    Box box{{}, {}, largest(node.limit)};
    const auto n =
        std::count_if(node.limit.begin(), node.limit.end(), [](float limit) { return limit >= 0; });
    for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = *std::min_element(node.lo[k].begin(), node.lo[k].begin() + n);
        box.hi[k] = *std::max_element(node.hi[k].begin(), node.hi[k].begin() + n);
    }
    return box;
}

void WaitingPoints::fill_nodes(ooc::Context& context) {
    std::uint64_t first = 0;
    std::uint64_t n_children = leaves_.size();
    do {
        const std::uint64_t below = levels_.empty() ? 0 : levels_.back();
        const bool is_lowest = levels_.empty();
        levels_.push_back(first);
        const std::uint64_t count = divide_up(n_children, kFanOut);
        context.workers().for_ranges(
            count, kNodesPerTask, [&](std::uint64_t begin, std::uint64_t end) {
                for (std::uint64_t i = begin; i < end; ++i) {
                    Node& node = nodes_[first + i];
                    for (std::size_t c = 0; c < kFanOut; ++c) {
                        const std::uint64_t child = i * kFanOut + c;
                        Box box{{}, {}, -1};
                        if (child < n_children) {
                            box =
                                is_lowest ? box_of_leaf(child) : box_of_node(nodes_[below + child]);
                        }
                        for (std::size_t k = 0; k < 3; ++k) {
                            node.lo[k][c] = box.lo[k];
                            node.hi[k][c] = box.hi[k];
                        }
                        node.limit[c] = box.limit;
                    }
                }
            });
        first += count;
        n_children = count;
    } while (n_children > 1);
}

void WaitingPoints::settle(ooc::Context& context, ooc::Array<LatticeTriangle> far,
                           std::uint64_t n_far) {
    const TriangleIndex index(context, std::move(far), n_far);
    context.workers().for_ranges(
        leaves_.size(), kLeavesPerTask, [&](std::uint64_t begin, std::uint64_t end) {
            TriangleIndex::Walk walk(index);
            std::array<double, kLeaf> limits;
            for (std::uint64_t l = begin; l < end; ++l) {
                const std::uint64_t first = l * kLeaf;
                const auto n =
                    static_cast<std::size_t>(std::min<std::uint64_t>(kLeaf, size() - first));
                for (std::size_t i = 0; i < n; ++i) {
                    const Vec3& q = points_[first + i];
                    limits[i] = distance_to_noted(rounded(q));
                    // What is farther than the next cells came by a collision of the hash.
                    constexpr double kCells = 3.5;
                    if (limits[i] <= std::ldexp(kCells, cell_bits_)) continue;
                    limits[i] = std::min(
                        limits[i], std::sqrt(walk.nearest(q).squared_distance) * (1 + 0x1p-40) + 1);
                }
                fill_leaf(l, std::span(limits).first(n));
            }
            context.check_stop();
        });
    grid_.release();
    fill_nodes(context);
}

void WaitingPoints::meet(std::span<const LatticeTriangle> triangles) {
    Corners all{};
    std::int64_t largest_size = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Corners box = corners_of(triangles[i]);
        Corners both = box;
        std::int64_t size = 0;
        std::int64_t spread = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            size = std::max(size, std::int64_t{box.hi[k]} - box.lo[k]);
            if (i != first) {
                both.lo[k] = std::min(all.lo[k], box.lo[k]);
                both.hi[k] = std::max(all.hi[k], box.hi[k]);
            }
            spread = std::max(spread, std::int64_t{both.hi[k]} - both.lo[k]);
        }
        largest_size = std::max(largest_size, size);
        if (i - first == kMostTogether || (i != first && spread > kMostSpread * largest_size)) {
            meet_group(triangles.subspan(first, i - first), all);
            first = i;
            all = box;
            largest_size = size;
        } else {
            all = both;
        }
    }
    if (first < triangles.size()) meet_group(triangles.subspan(first), all);
}

/// Squared distances of `box` to those of the children.
HEWER_INLINE std::array<float, WaitingPoints::kFanOut> WaitingPoints::child_distances(
    const Node& node, const Corners& box) {
    std::array<float, kFanOut> d2;
    for (std::size_t c = 0; c < kFanOut; ++c) {
        float sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto d = static_cast<float>(
                std::max(std::max(node.lo[k][c] - box.hi[k], box.lo[k] - node.hi[k][c]), 0));
            sum += d * d;
        }
        d2[c] = sum;
    }
    return d2;
}

HEWER_VECTOR_CLONES void WaitingPoints::meet_group(std::span<const LatticeTriangle> group,
                                                   const Corners& all) {
    struct Visit {
        std::uint32_t level;
        std::uint64_t number;  // within its level
    };
    std::array<Visit, kMostVisits> stack;
    std::size_t n_stack = 0;
    stack[n_stack++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
    while (n_stack > 0) {
        const Visit visit = stack[--n_stack];
        Node& node = nodes_[levels_[visit.level] + visit.number];
        const std::array<float, kFanOut> d2 = child_distances(node, all);
        for (std::size_t c = 0; c < kFanOut; ++c) {
            const std::atomic_ref<float> limit(node.limit[c]);
            if (d2[c] > limit.load(std::memory_order_relaxed)) continue;
            const std::uint64_t child = visit.number * kFanOut + c;
            if (visit.level > 0) {
                stack[n_stack++] = {visit.level - 1, child};
                continue;
            }
            for (const LatticeTriangle& t : group) {
                const Corners box = corners_of(t);
                float sum = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto d = static_cast<float>(std::max(
                        std::max(node.lo[k][c] - box.hi[k], box.lo[k] - node.hi[k][c]), 0));
                    sum += d * d;
                }
                if (sum <= limit.load(std::memory_order_relaxed)) meet_leaf(child, t, box);
            }
            lower_to(node.limit[c], largest(leaves_[child].limit));
        }
        if (visit.level + 1 < levels_.size()) {
            Node& parent = nodes_[levels_[visit.level + 1] + visit.number / kFanOut];
            lower_to(parent.limit[visit.number % kFanOut], largest(node.limit));
        }
    }
}

HEWER_INLINE void WaitingPoints::meet_point(std::uint64_t number, const LatticeTriangle& t,
                                            float& limit) {
    const std::atomic_ref<double> best(best_[number]);
    const double now = best.load(std::memory_order_relaxed);
    const double d = measuring::squared_distance(points_[number], t, now);
    if (d < now) {
        lower_to(best_[number], d);
        lower_to(limit, with_slack(d));
    }
}

HEWER_INLINE void WaitingPoints::meet_piece(std::uint64_t number, const LatticeTriangle& t,
                                            float& limit) {
    if (measuring::squared_distance(points_[number], t, enough_) > enough_) return;
    const std::atomic_ref<double> best(best_[number]);
    const double now = best.load(std::memory_order_relaxed);
    const double d = measuring::squared_distance(pieces_[number], t, now);
    if (d > now) return;
    const std::lock_guard lock((*locks_)[number % kLocks]);
    if (d < best_[number] || (d == best_[number] && t < nearest_[number])) {
        best.store(d, std::memory_order_relaxed);
        nearest_[number] = t;
    }
    if (d <= enough_) lower_to(limit, -1.0F);
}

HEWER_INLINE void WaitingPoints::meet_leaf(std::uint64_t l, const LatticeTriangle& t,
                                           const Corners& box) {
    Leaf& leaf = leaves_[l];
    std::array<float, kLeaf> d2;
    for (std::size_t i = 0; i < kLeaf; ++i) {
        float sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t x = leaf.at[k][i];
            const auto d = static_cast<float>(std::max(std::max(box.lo[k] - x, x - box.hi[k]), 0));
            sum += d * d;
        }
        d2[i] = sum;
    }
    for (std::size_t i = 0; i < kLeaf; ++i) {
        const std::atomic_ref<float> limit(leaf.limit[i]);
        if (d2[i] > limit.load(std::memory_order_relaxed)) continue;
        if (pieces_.empty()) {
            meet_point(l * kLeaf + i, t, leaf.limit[i]);
        } else {
            meet_piece(l * kLeaf + i, t, leaf.limit[i]);
        }
    }
}

}  // namespace hewer::measuring
