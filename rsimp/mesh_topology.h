// SPDX-License-Identifier: MIT
/// Edges and components of a mesh that need not fit in memory, in one pass over windows of faces.
#pragma once

#include <cstdint>
#include <vector>

#include "hewer/report.h"
#include "ooc/context.h"
#include "ooc/min_heap.h"
#include "rsimp/face_window.h"

namespace hewer::rsimp {

struct EdgeTally {
    std::uint64_t edges = 0;
    std::uint64_t border = 0;       ///< one face
    std::uint64_t nonmanifold = 0;  ///< more than two faces
};

/// What a window says of its own edges and components: all that can be done without the others.
struct WindowTopology {
    struct Edge {
        std::uint32_t high;  ///< larger vertex, by its place in the window
        std::uint32_t n_faces;
    };
    std::vector<std::uint32_t> first_edge;  ///< of each vertex as the smaller one, and the end
    std::vector<Edge> edges;                ///< by smaller vertex, then larger
    std::vector<std::uint32_t> component;   ///< smallest vertex of the component of each vertex
    std::uint64_t n_components = 0;
    std::uint32_t n_settled = 0;  ///< vertices that no later face has
    EdgeTally tally;              ///< of the edges whose smaller vertex is settled
};

/// Any thread.
WindowTopology count_window(const FaceWindow& window);

/// Counts what a reader of the file would count. Faces rise by their smallest vertex, so when that
/// has passed a vertex, all faces around the vertex have been there: an edge is settled with its
/// smaller vertex, and only the vertices and edges that reach ahead of the window wait for others,
/// in two heaps. One thread, windows in order.
///
/// Memory: 24 bytes for each edge and 16 for each vertex ahead of the faces seen so far, twice that
/// while a heap grows: along the Morton curve these are the border of the surface seen, not the
/// surface. 8 bytes for each component of a window that reaches ahead.
class TopologyCounter {
  public:
    explicit TopologyCounter(ooc::Context& context);

    void add(const FaceWindow& window, const WindowTopology& topology);

    /// After the last window.
    [[nodiscard]] TopologyReport report(std::uint64_t n_vertices, std::uint64_t n_faces) const;

  private:
    struct OpenEdge {
        std::uint64_t low;
        std::uint64_t high;
        std::uint64_t n_faces;
        bool operator<(const OpenEdge& o) const {
            return low != o.low ? low < o.low : high < o.high;
        }
    };
    struct OpenVertex {
        std::uint64_t vertex;
        std::uint64_t label;
        bool operator<(const OpenVertex& o) const {
            return vertex != o.vertex ? vertex < o.vertex : label < o.label;
        }
    };
    void settle_edges(const FaceWindow& window, const WindowTopology& topology);
    void join_components(const FaceWindow& window, const WindowTopology& topology);
    std::uint64_t find(std::uint64_t label);
    void join(std::uint64_t a, std::uint64_t b);

    ooc::MinHeap<OpenEdge> open_edges_;
    ooc::MinHeap<OpenVertex> open_vertices_;
    std::vector<std::uint64_t> parent_;  // of the labels of components that reach ahead
    EdgeTally tally_;
    std::uint64_t n_components_ = 0;
};

}  // namespace hewer::rsimp
