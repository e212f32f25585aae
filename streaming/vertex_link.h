// SPDX-License-Identifier: MIT
/// What the faces around one vertex say about the topology of a mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hewer::streaming {

/// Every edge is told of by its smaller vertex, so that sums over all vertices count it once.
struct LinkTally {
    std::uint64_t edges = 0;
    std::uint64_t border_edges = 0;          ///< one face
    std::uint64_t nonmanifold_edges = 0;     ///< more than two faces
    std::uint64_t nonmanifold_vertices = 0;  ///< their faces are not one fan
    std::uint64_t border_vertices = 0;       ///< with a border edge, to either side

    LinkTally& operator+=(const LinkTally& o) {
        edges += o.edges;
        border_edges += o.border_edges;
        nonmanifold_edges += o.nonmanifold_edges;
        nonmanifold_vertices += o.nonmanifold_vertices;
        border_vertices += o.border_vertices;
        return *this;
    }
    LinkTally& operator-=(const LinkTally& o) {
        edges -= o.edges;
        border_edges -= o.border_edges;
        nonmanifold_edges -= o.nonmanifold_edges;
        nonmanifold_vertices -= o.nonmanifold_vertices;
        border_vertices -= o.border_vertices;
        return *this;
    }
};

/// Judges vertices one by one. An edge has as many faces as its other end comes up among the
/// corners opposite the vertex; faces that share such an edge hang together. A vertex is manifold
/// if all of its faces hang together and no edge at it has more than two. Memory: 20 bytes a face
/// of the vertex with the most.
template <typename Id>
class VertexLink {
  public:
    /// The other two corners of a face.
    using Opposite = std::array<Id, 2>;

    /// All faces at `vertex`, in any order, without repeated corners; on_border(u) for the border
    /// edges to larger vertices u.
    template <typename OnBorder>
    LinkTally judge(Id vertex, std::span<const Opposite> faces, const OnBorder& on_border) {
        ends_.clear();
        label_.clear();
        for (std::uint32_t f = 0; f < faces.size(); ++f) {
            ends_.push_back({faces[f][0], f});
            ends_.push_back({faces[f][1], f});
            label_.push_back(f);
        }
        std::sort(ends_.begin(), ends_.end(),
                  [](const End& a, const End& b) { return a.neighbour < b.neighbour; });
        LinkTally tally;
        std::size_t n_fans = faces.size();
        bool has_border = false;
        bool has_nonmanifold = false;
        for (std::size_t first = 0, last = 0; first < ends_.size(); first = last) {
            const Id u = ends_[first].neighbour;
            for (last = first + 1; last < ends_.size() && ends_[last].neighbour == u; ++last) {
                if (join(ends_[first].face, ends_[last].face)) --n_fans;
            }
            const std::size_t n = last - first;
            has_border |= n == 1;
            has_nonmanifold |= n > 2;
            if (u < vertex) continue;
            ++tally.edges;
            if (n > 2) ++tally.nonmanifold_edges;
            if (n == 1) {
                ++tally.border_edges;
                on_border(u);
            }
        }
        if (has_border) tally.border_vertices = 1;
        if (has_nonmanifold || n_fans > 1) tally.nonmanifold_vertices = 1;
        return tally;
    }

  private:
    struct End {
        Id neighbour;
        std::uint32_t face;
    };
    std::uint32_t find(std::uint32_t f) {
        while (label_[f] != f) f = label_[f] = label_[label_[f]];
        return f;
    }
    bool join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) return false;
        label_[std::max(a, b)] = std::min(a, b);
        return true;
    }
    std::vector<End> ends_;
    std::vector<std::uint32_t> label_;  // of the fan of each face
};

}  // namespace hewer::streaming
