// SPDX-License-Identifier: MIT
#include "rsimp/mesh_topology.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "ooc/array.h"
#include "ooc/external_sort.h"
#include "ooc/parallel.h"

namespace hewer::rsimp {

namespace {

using IndexFace = std::array<std::uint32_t, 3>;
using Edge = std::uint64_t;  // smaller vertex in the upper half

constexpr std::uint64_t kWindow = 1 << 16;
constexpr std::uint64_t kSortBytes = 2 << 20;

struct EdgeTally {
    std::uint64_t edges = 0;
    std::uint64_t border = 0;
    std::uint64_t nonmanifold = 0;

    void add_group(std::uint64_t n_faces) {
        ++edges;
        if (n_faces == 1) ++border;
        if (n_faces > 2) ++nonmanifold;
    }
    EdgeTally& operator+=(const EdgeTally& other) {
        edges += other.edges;
        border += other.border;
        nonmanifold += other.nonmanifold;
        return *this;
    }
};

class Flags {
  public:
    Flags(ooc::Context& context, std::uint64_t n)
        : words_(context.budget(), "vertex flags", (n + 63) / 64) {}
    [[nodiscard]] bool get(std::uint32_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
    void set(std::uint32_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }

  private:
    ooc::Array<std::uint64_t> words_;
};

/// Vertices that more than one window uses; counts components on the way.
std::uint64_t find_shared(ooc::Context& context, const ooc::Spool<IndexFace>& faces,
                          std::uint64_t n_vertices, Flags& is_shared) {
    ooc::Array<std::uint32_t> label(context.budget(), "components", n_vertices);
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    std::uint64_t n_components = n_vertices;
    Flags is_used(context, n_vertices);
    std::vector<std::uint32_t> used;  // by the window
    ooc::SpoolReader<IndexFace> reader(faces);
    for (std::uint64_t f = 0; f < faces.size(); ++f) {
        const IndexFace& t = *reader.next();
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            if (a == b) continue;
            label[std::max(a, b)] = std::min(a, b);
            --n_components;
        }
        for (const std::uint32_t v : t) {
            if (is_used.get(v)) {
                is_shared.set(v);
            } else {
                used.push_back(v);
            }
        }
        if ((f + 1) % kWindow == 0) {
            for (const std::uint32_t v : used) is_used.set(v);
            used.clear();
            context.check_stop();
        }
    }
    return n_components;
}

}  // namespace

TopologyReport count_topology(ooc::Context& context, const ooc::Spool<IndexFace>& faces,
                              std::uint64_t n_vertices) {
    TopologyReport report;
    Flags is_shared(context, n_vertices);
    report.components = find_shared(context, faces, n_vertices, is_shared);
    ooc::ExternalSorter<Edge, std::less<>> seams(context, "edges between windows", {}, kSortBytes);
    EdgeTally total;
    struct Window {
        EdgeTally tally;
        std::vector<Edge> seams;
    };
    context.workers().in_order(
        (faces.size() + kWindow - 1) / kWindow, 2 * context.n_threads(),
        [&](std::uint64_t w) {
            Window window;
            const std::uint64_t first = w * kWindow;
            std::vector<IndexFace> own(std::min(kWindow, faces.size() - first));
            faces.read(first, own);
            std::vector<Edge> edges;
            edges.reserve(3 * own.size());
            for (const IndexFace& t : own) {
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
                    const Edge edge = Edge{low} << 32 | high;
                    (is_shared.get(low) && is_shared.get(high) ? window.seams : edges)
                        .push_back(edge);
                }
            }
            std::sort(edges.begin(), edges.end());
            for (auto p = edges.begin(); p != edges.end();) {
                const auto q = std::upper_bound(p, std::min(p + 8, edges.end()), *p);
                const auto end = q == p + 8 ? std::upper_bound(q, edges.end(), *p) : q;
                window.tally.add_group(static_cast<std::uint64_t>(end - p));
                p = end;
            }
            context.check_stop();
            return window;
        },
        [&](std::uint64_t, const Window& window) {
            total += window.tally;
            seams.add(window.seams);
        });
    const ooc::Spool<Edge> sorted = seams.finish();
    ooc::SpoolReader<Edge> reader(sorted);
    std::uint64_t n = 0;
    Edge last = 0;
    while (const Edge* edge = reader.next()) {
        if (n > 0 && *edge != last) {
            total.add_group(n);
            n = 0;
        }
        last = *edge;
        ++n;
    }
    if (n > 0) total.add_group(n);
    report.border_edges = total.border;
    report.nonmanifold_edges = total.nonmanifold;
    report.euler_characteristic = static_cast<std::int64_t>(n_vertices) -
                                  static_cast<std::int64_t>(total.edges) +
                                  static_cast<std::int64_t>(faces.size());
    return report;
}

}  // namespace hewer::rsimp
