// SPDX-License-Identifier: MIT
#include "rsimp/mesh_topology.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

namespace hewer::rsimp {

namespace {

void classify(EdgeTally& tally, std::uint64_t n_faces) {
    ++tally.edges;
    if (n_faces == 1) ++tally.border;
    if (n_faces > 2) ++tally.nonmanifold;
}

void take_back(EdgeTally& tally, std::uint64_t n_faces) {
    --tally.edges;
    if (n_faces == 1) --tally.border;
    if (n_faces > 2) --tally.nonmanifold;
}

/// Edges in order, by counting for the smaller vertex and sorting the few larger ones of each.
void gather_edges(const FaceWindow& window, WindowTopology& t) {
    const std::size_t n = window.vertices.size();
    std::vector<std::uint32_t> start(n + 2);
    for (const auto& f : window.faces) {
        for (std::size_t i = 0; i < 3; ++i) ++start[std::min(f[i], f[(i + 1) % 3]) + 2];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<std::uint32_t> high(3 * window.faces.size());
    for (const auto& f : window.faces) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [a, b] = std::minmax(f[i], f[(i + 1) % 3]);
            high[start[a + 1]++] = b;
        }
    }
    t.first_edge.reserve(n + 1);
    t.edges.reserve(high.size() / 2 + n / 8);
    for (std::size_t v = 0; v < n; ++v) {
        t.first_edge.push_back(static_cast<std::uint32_t>(t.edges.size()));
        std::sort(high.begin() + start[v], high.begin() + start[v + 1]);
        for (std::uint32_t i = start[v]; i < start[v + 1]; ++i) {
            if (i > start[v] && high[i] == high[i - 1]) {
                ++t.edges.back().n_faces;
            } else {
                t.edges.push_back({high[i], 1});
            }
        }
    }
    t.first_edge.push_back(static_cast<std::uint32_t>(t.edges.size()));
}

void label_components(const FaceWindow& window, WindowTopology& t) {
    std::vector<std::uint32_t>& label = t.component;
    label.resize(window.vertices.size());
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    for (const auto& f : window.faces) {
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(f[0]);
            const std::uint32_t b = find(f[i]);
            label[std::max(a, b)] = std::min(a, b);
        }
    }
    // Labels never exceed their vertices, so those before are final.
    for (std::uint32_t v = 0; v < label.size(); ++v) {
        if (label[v] == v) {
            ++t.n_components;
        } else {
            label[v] = label[label[v]];
        }
    }
}

std::optional<std::uint32_t> place_of(const FaceWindow& window, std::uint64_t vertex) {
    const auto it = std::lower_bound(window.vertices.begin(), window.vertices.end(), vertex);
    if (it == window.vertices.end() || *it != vertex) return {};
    return static_cast<std::uint32_t>(it - window.vertices.begin());
}

/// Faces of the window at an edge.
std::uint64_t faces_at(const FaceWindow& window, const WindowTopology& t, std::uint64_t low,
                       std::uint64_t high) {
    const auto a = place_of(window, low);
    const auto b = place_of(window, high);
    if (!a || !b) return 0;
    for (std::uint32_t e = t.first_edge[*a]; e < t.first_edge[*a + 1]; ++e) {
        if (t.edges[e].high == *b) return t.edges[e].n_faces;
    }
    return 0;
}

}  // namespace

WindowTopology count_window(const FaceWindow& window) {
    WindowTopology t;
    gather_edges(window, t);
    label_components(window, t);
    t.n_settled = static_cast<std::uint32_t>(
        std::lower_bound(window.vertices.begin(), window.vertices.end(), window.next) -
        window.vertices.begin());
    for (std::uint32_t e = 0; e < t.first_edge[t.n_settled]; ++e) {
        classify(t.tally, t.edges[e].n_faces);
    }
    return t;
}

TopologyCounter::TopologyCounter(ooc::Context& context)
    : open_edges_(context.budget(), "open edges"),
      open_vertices_(context.budget(), "open vertices") {}

void TopologyCounter::add(const FaceWindow& window, const WindowTopology& topology) {
    settle_edges(window, topology);
    join_components(window, topology);
}

void TopologyCounter::settle_edges(const FaceWindow& window, const WindowTopology& t) {
    tally_.edges += t.tally.edges;
    tally_.border += t.tally.border;
    tally_.nonmanifold += t.tally.nonmanifold;
    while (!open_edges_.empty() && open_edges_.top().low < window.next) {
        OpenEdge edge = open_edges_.top();
        open_edges_.pop();
        while (!open_edges_.empty() && open_edges_.top().low == edge.low &&
               open_edges_.top().high == edge.high) {
            edge.n_faces += open_edges_.top().n_faces;
            open_edges_.pop();
        }
        const std::uint64_t own = faces_at(window, t, edge.low, edge.high);
        if (own > 0) take_back(tally_, own);
        classify(tally_, own + edge.n_faces);
    }
    for (std::size_t v = t.n_settled; v < window.vertices.size(); ++v) {
        for (std::uint32_t e = t.first_edge[v]; e < t.first_edge[v + 1]; ++e) {
            open_edges_.push(
                {window.vertices[v], window.vertices[t.edges[e].high], t.edges[e].n_faces});
        }
    }
}

std::uint64_t TopologyCounter::find(std::uint64_t label) {
    while (parent_[label] != label) label = parent_[label] = parent_[parent_[label]];
    return label;
}

void TopologyCounter::join(std::uint64_t a, std::uint64_t b) {
    a = find(a);
    b = find(b);
    if (a == b) return;
    parent_[std::max(a, b)] = std::min(a, b);
    --n_components_;
}

void TopologyCounter::join_components(const FaceWindow& window, const WindowTopology& t) {
    constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    n_components_ += t.n_components;
    std::vector<std::uint64_t> labels(window.vertices.size(), kNone);  // of components
    const auto label_of = [&](std::size_t place) {
        std::uint64_t& label = labels[t.component[place]];
        if (label == kNone) {
            label = parent_.size();
            parent_.push_back(label);
        }
        return label;
    };
    while (!open_vertices_.empty() && open_vertices_.top().vertex < window.next) {
        const OpenVertex first = open_vertices_.top();
        open_vertices_.pop();
        while (!open_vertices_.empty() && open_vertices_.top().vertex == first.vertex) {
            join(first.label, open_vertices_.top().label);
            open_vertices_.pop();
        }
        if (const auto place = place_of(window, first.vertex)) join(first.label, label_of(*place));
    }
    for (std::size_t v = t.n_settled; v < window.vertices.size(); ++v) {
        open_vertices_.push({window.vertices[v], label_of(v)});
    }
}

TopologyReport TopologyCounter::report(std::uint64_t n_vertices, std::uint64_t n_faces) const {
    TopologyReport report;
    report.border_edges = tally_.border;
    report.nonmanifold_edges = tally_.nonmanifold;
    report.components = n_components_;
    report.euler_characteristic = static_cast<std::int64_t>(n_vertices) -
                                  static_cast<std::int64_t>(tally_.edges) +
                                  static_cast<std::int64_t>(n_faces);
    return report;
}

}  // namespace hewer::rsimp
