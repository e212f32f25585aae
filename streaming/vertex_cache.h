// SPDX-License-Identifier: MIT
/// The vertices that the triangles at hand use.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ooc/array.h"
#include "ooc/context.h"
#include "streaming/corner_join.h"

namespace hewer::streaming {

/// Real scans are coherent: triangles that are near each other in the file use vertices that are
/// near each other in the file. So lines of consecutive vertices are loaded when one of them is
/// asked for, and kept until their place is needed: two places for each, of which the one that was
/// used last stays. One worker's own: nothing is shared, so nothing is locked; what several workers
/// load twice costs less than that.
/// Memory: `bytes`, reserved, but room for kLeastLines lines at least.
template <typename Point>
class VertexCache {
  public:
    static constexpr unsigned kLineBits = 10;
    static constexpr std::uint64_t kLineVertices = std::uint64_t{1} << kLineBits;
    static constexpr std::uint64_t kLineBytes = kLineVertices * sizeof(Point);
    static constexpr std::uint64_t kLeastLines = 16;

    /// `load` must outlive the cache.
    VertexCache(ooc::Context& context, std::uint64_t n_vertices, const LoadVertices<Point>& load,
                std::uint64_t bytes)
        : load_(load),
          n_vertices_(n_vertices),
          n_sets_(std::max(kLeastLines, bytes / (kLineBytes + sizeof(Set))) / kWays),
          sets_(context.budget(), "lines of vertices", n_sets_),
          points_(context.budget(), "lines of vertices", n_sets_ * kWays * kLineVertices) {
        for (Set& set : sets_) set.lines.fill(kNone);
    }

    /// Valid until the next call.
    const Point& at(std::uint64_t vertex) {
        const std::uint64_t line = vertex >> kLineBits;
        const std::uint64_t s = line % n_sets_;
        Set& set = sets_[s];
        std::size_t way = set.lines[0] == line ? 0 : 1;
        if (set.lines[way] != line) way = load_line(set, s, line);
        set.last = way;
        return points_[((s * kWays + way) << kLineBits) + (vertex & (kLineVertices - 1))];
    }

    /// Of vertices.
    [[nodiscard]] std::uint64_t n_loads() const { return n_loads_; }
    [[nodiscard]] std::uint64_t capacity() const { return points_.size(); }

  private:
    static constexpr std::size_t kWays = 2;
    static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    struct Set {
        std::array<std::uint64_t, kWays> lines;
        std::uint64_t last;  // way
    };

    std::size_t load_line(Set& set, std::uint64_t s, std::uint64_t line) {
        const std::size_t way = 1 - set.last;
        const std::uint64_t first = line << kLineBits;
        const std::uint64_t n = std::min(kLineVertices, n_vertices_ - first);
        set.lines[way] = kNone;  // should load() throw
        load_(first, n, points_.data() + ((s * kWays + way) << kLineBits));
        set.lines[way] = line;
        n_loads_ += n;
        return way;
    }

    const LoadVertices<Point>& load_;
    std::uint64_t n_vertices_;
    std::uint64_t n_sets_;
    ooc::Array<Set> sets_;
    ooc::Array<Point> points_;
    std::uint64_t n_loads_ = 0;
};

}  // namespace hewer::streaming
