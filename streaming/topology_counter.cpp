// SPDX-License-Identifier: MIT
#include "streaming/topology_counter.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

#include "ooc/external_sort.h"

namespace hewer::streaming {

namespace {

void gather_corners(const FaceWindow& window, WindowTopology& t) {
    const std::size_t n = window.vertices.size();
    std::vector<std::uint32_t>& first = t.first_corner;
    first.resize(n + 2);
    for (const auto& f : window.faces) {
        for (const std::uint32_t v : f) ++first[v + 2];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    t.corners.resize(3 * window.faces.size());
    for (const auto& f : window.faces) {
        for (std::size_t i = 0; i < 3; ++i) {
            t.corners[first[f[i] + 1]++] = {f[(i + 1) % 3], f[(i + 2) % 3]};
        }
    }
    first.pop_back();
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
    for (std::uint32_t v = 0; v < label.size(); ++v) label[v] = label[label[v]];
}

}  // namespace

WindowTopology count_window(const FaceWindow& window) {
    WindowTopology t;
    gather_corners(window, t);
    label_components(window, t);
    t.n_settled = static_cast<std::uint32_t>(
        std::lower_bound(window.vertices.begin(), window.vertices.end(), window.next) -
        window.vertices.begin());
    t.links.reserve(t.n_settled);
    VertexLink<std::uint32_t> link;
    for (std::uint32_t v = 0; v < t.n_settled; ++v) {
        const auto faces = std::span(t.corners).subspan(t.first_corner[v],
                                                        t.first_corner[v + 1] - t.first_corner[v]);
        t.links.push_back(link.judge(v, faces, [&](std::uint32_t u) {
            t.border_edges.push_back({v, u});
        }));
    }
    return t;
}

/// Corners in an external sort.
class TopologyCounter::WaitingCorners {
  public:
    using OnBorder = std::function<void(std::uint64_t, std::uint64_t)>;
    virtual ~WaitingCorners() = default;
    virtual void add(std::uint64_t vertex, std::uint64_t a, std::uint64_t b) = 0;
    /// Judges all vertices that have corners here. Returns how many there are.
    virtual std::uint64_t judge(LinkTally& tally, const OnBorder& on_border) = 0;
};

template <typename Id>
class TopologyCounter::SortedCorners final : public WaitingCorners {
  public:
    SortedCorners(ooc::Context& context, std::uint64_t sort_bytes)
        : context_(context), sorter_(context, kWhat, {}, sort_bytes) {}

    void add(std::uint64_t vertex, std::uint64_t a, std::uint64_t b) override {
        sorter_.add({static_cast<Id>(vertex), static_cast<Id>(a), static_cast<Id>(b)});
    }

    std::uint64_t judge(LinkTally& tally, const OnBorder& on_border) override {
        auto sorted = sorter_.stream();
        VertexLink<Id> link;
        std::vector<typename VertexLink<Id>::Opposite> faces;
        ooc::Reservation bytes;
        std::uint64_t n_vertices = 0;
        while (const Corner* corner = sorted.next()) {
            const Id vertex = (*corner)[0];
            faces.assign(1, {(*corner)[1], (*corner)[2]});
            while (sorted.peek() != nullptr && (*sorted.peek())[0] == vertex) {
                corner = sorted.next();
                if (faces.size() >= kMostFacesUncounted &&
                    faces.size() * kBytesPerFace > bytes.bytes()) {
                    bytes.release();
                    bytes = context_.budget().reserve("the faces of one vertex",
                                                      2 * faces.size() * kBytesPerFace);
                }
                faces.push_back({(*corner)[1], (*corner)[2]});
            }
            tally += link.judge(vertex, faces, [&](Id u) { on_border(vertex, u); });
            constexpr std::uint64_t kBetween = 1 << 16;
            if (++n_vertices % kBetween == 0) context_.check_stop();
        }
        return n_vertices;
    }

  private:
    using Corner = std::array<Id, 3>;
    static constexpr const char* kWhat = "corners of faces, by vertex";
    static constexpr std::size_t kMostFacesUncounted = 1 << 14;
    static constexpr std::uint64_t kBytesPerFace = sizeof(Corner) + 40;
    ooc::Context& context_;
    ooc::ExternalSorter<Corner, std::less<>> sorter_;
};

TopologyCounter::TopologyCounter(ooc::Context& context, std::uint64_t n_vertices,
                                 std::uint64_t sort_bytes)
    : context_(context),
      sort_bytes_(sort_bytes),
      sets_(context.budget(), "components of a surface", n_vertices),
      border_edges_(context, "border edges") {}

TopologyCounter::~TopologyCounter() = default;

void TopologyCounter::wait(std::uint64_t vertex, std::uint64_t a, std::uint64_t b) {
    if (!waiting_) {
        if (sets_.size() <= std::numeric_limits<std::uint32_t>::max()) {
            waiting_ = std::make_unique<SortedCorners<std::uint32_t>>(context_, sort_bytes_);
        } else {
            waiting_ = std::make_unique<SortedCorners<std::uint64_t>>(context_, sort_bytes_);
        }
    }
    waiting_->add(vertex, a, b);
}

void TopologyCounter::add(const FaceWindow& window, const WindowTopology& t) {
    if (open_.empty()) open_ = {context_.budget(), "open vertices", sets_.size() / 64 + 1};
    n_faces_ += window.faces.size();
    const std::vector<std::uint64_t>& vertices = window.vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const std::uint64_t vertex = vertices[v];
        if (t.component[v] != v && sets_.join(vertex, vertices[t.component[v]])) ++n_joins_;
        if (v < t.n_settled && !is_open(vertex)) {
            tally_ += t.links[v];
            ++n_vertices_;
            continue;
        }
        open_[vertex / 64] |= std::uint64_t{1} << (vertex % 64);
        for (std::uint32_t i = t.first_corner[v]; i < t.first_corner[v + 1]; ++i) {
            wait(vertex, vertices[t.corners[i][0]], vertices[t.corners[i][1]]);
        }
    }
    for (const auto& [v, u] : t.border_edges) {
        if (!is_open(vertices[v])) border_edges_.push({vertices[v], vertices[u]});
    }
}

void TopologyCounter::add(std::span<const Triangle> faces) {
    for (const Triangle& f : faces) {
        if (f[0] == f[1] || f[1] == f[2] || f[0] == f[2]) continue;
        ++n_faces_;
        for (std::size_t i = 0; i < 3; ++i) wait(f[i], f[(i + 1) % 3], f[(i + 2) % 3]);
        if (sets_.join(f[0], f[1])) ++n_joins_;
        if (sets_.join(f[1], f[2])) ++n_joins_;
    }
}

std::uint64_t TopologyCounter::count_border_loops() {
    sets_.separate();
    std::uint64_t n_joins = 0;
    ooc::SpoolReader<std::array<std::uint64_t, 2>> reader(border_edges_);
    while (const auto* edge = reader.next()) {
        if (sets_.join((*edge)[0], (*edge)[1])) ++n_joins;
    }
    return tally_.border_vertices - n_joins;
}

TopologyReport TopologyCounter::finish() {
    if (waiting_) {
        n_vertices_ += waiting_->judge(tally_, [&](std::uint64_t v, std::uint64_t u) {
            border_edges_.push({v, u});
        });
        waiting_.reset();
    }
    TopologyReport report;
    report.components = n_vertices_ - n_joins_;
    report.border_edges = tally_.border_edges;
    report.border_loops = count_border_loops();
    report.nonmanifold_edges = tally_.nonmanifold_edges;
    report.nonmanifold_vertices = tally_.nonmanifold_vertices;
    report.euler = static_cast<std::int64_t>(n_vertices_) -
                   static_cast<std::int64_t>(tally_.edges) + static_cast<std::int64_t>(n_faces_);
    return report;
}

}  // namespace hewer::streaming
