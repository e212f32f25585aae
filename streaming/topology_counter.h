// SPDX-License-Identifier: MIT
/// Borders, fans and components of a mesh that need not fit in memory, in one pass over its faces.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hewer/report.h"
#include "hewer/types.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/disjoint_sets.h"
#include "ooc/spool.h"
#include "streaming/face_window.h"
#include "streaming/vertex_link.h"

namespace hewer::streaming {

/// What a window says of its own vertices: all that can be done without the other windows. A vertex
/// is settled if no later face has it.
struct WindowTopology {
    using Opposite = VertexLink<std::uint32_t>::Opposite;
    std::vector<std::uint32_t> first_corner;  ///< of each vertex, and the end
    std::vector<Opposite> corners;            ///< the rest of each face, by vertex
    std::vector<std::uint32_t> component;     ///< smallest vertex of the component of each vertex
    std::uint32_t n_settled = 0;              ///< vertices: the first ones
    std::vector<LinkTally> links;             ///< of the settled vertices, by their faces here
    std::vector<std::array<std::uint32_t, 2>> border_edges;  ///< of these, by smaller vertex
};

/// Any thread.
WindowTopology count_window(const FaceWindow& window);

/// Counts what a reader of the file would count, by indices: every vertex is judged by all of its
/// faces (streaming/vertex_link.h). Where faces come in windows that rise by their smallest vertex,
/// most vertices have all of their faces in one window and are judged there and then. The corners
/// of the others, and all corners of faces in no order, wait in an external sort by vertex. One
/// thread at a time.
///
/// Memory: 4 bytes a vertex for the components (8 if there are more than 2^32), a bit a vertex for
/// windows, the sorter's buffer; at the end 40 bytes a face of the vertex with the most faces.
/// Disk, where memory is short: 12 bytes (24) a corner that waits, 16 a border edge. Throws:
/// OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
class TopologyCounter {
  public:
    /// Of a mesh with vertices 0 .. n_vertices - 1; those that no face has are not counted.
    TopologyCounter(ooc::Context& context, std::uint64_t n_vertices, std::uint64_t sort_bytes);
    ~TopologyCounter();

    /// Windows in order. Not together with the other add().
    void add(const FaceWindow& window, const WindowTopology& topology);
    /// Faces in any order. One with a repeated corner is left out.
    void add(std::span<const Triangle> faces);

    /// Ends the counter's life.
    TopologyReport finish();

  private:
    class WaitingCorners;
    template <typename Id>
    class SortedCorners;

    void wait(std::uint64_t vertex, std::uint64_t a, std::uint64_t b);
    [[nodiscard]] bool is_open(std::uint64_t v) const {
        return (open_[v / 64] >> (v % 64) & 1) != 0;
    }
    std::uint64_t count_border_loops();

    ooc::Context& context_;
    std::uint64_t sort_bytes_;
    ooc::DisjointSets sets_;
    ooc::Array<std::uint64_t> open_;  // a bit: corners of this vertex wait
    std::unique_ptr<WaitingCorners> waiting_;
    ooc::Spool<std::array<std::uint64_t, 2>> border_edges_;
    LinkTally tally_;
    std::uint64_t n_vertices_ = 0;  // that a face has
    std::uint64_t n_faces_ = 0;
    std::uint64_t n_joins_ = 0;
};

}  // namespace hewer::streaming
