// SPDX-License-Identifier: MIT
#include "streaming/topology_scan.h"

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "ooc/external_sort.h"
#include "streaming/equal_corners.h"
#include "streaming/topology_counter.h"

namespace hewer::streaming {

namespace {

/// A corner of the soup, and the vertex that it becomes.
using NumberedCorner = std::array<std::uint64_t, 2>;

/// Corners in the order of the triangles. Sorting by position tells which are equal, sorting by
/// number brings them back together.
template <typename Real>
ooc::Spool<NumberedCorner> number_vertices(ooc::Context& context, MeshSource& source,
                                           std::uint64_t& n_vertices) {
    ooc::ExternalSorter<NumberedCorner, std::less<>> by_number(context, "corners by triangle", {},
                                                               ample_sort_bytes(context));
    n_vertices = 0;
    for_equal_corners<Real>(
        context, source,
        [&](const std::array<Real, 3>&, std::uint64_t first, std::uint64_t number) {
            if (number == first) ++n_vertices;
            by_number.add({number, n_vertices - 1});
        });
    return by_number.finish();
}

void add_triangles(ooc::Context& context, ooc::Spool<NumberedCorner> corners,
                   TopologyCounter& counter) {
    constexpr std::size_t kPiece = 1 << 13;
    ooc::SpoolReader<NumberedCorner> reader(corners);
    std::vector<Triangle> piece;
    while (reader.peek() != nullptr) {
        piece.clear();
        while (piece.size() < kPiece && reader.peek() != nullptr) {
            Triangle& t = piece.emplace_back();
            for (std::uint64_t& v : t) v = (*reader.next())[1];
        }
        counter.add(piece);
        corners.discard_before(reader.position());
        context.check_stop();
    }
}

TopologyReport count_soup(ooc::Context& context, MeshSource& source) {
    std::uint64_t n_vertices = 0;
    ooc::Spool<NumberedCorner> corners;
    if (source.info().has_double_positions) {
        corners = number_vertices<double>(context, source, n_vertices);
    } else {
        corners = number_vertices<float>(context, source, n_vertices);
    }
    TopologyCounter counter(context, n_vertices, ample_sort_bytes(context));
    add_triangles(context, std::move(corners), counter);
    return counter.finish();
}

}  // namespace

TopologyReport count_topology(ooc::Context& context, MeshSource& source) {
    if (!source.info().is_indexed) return count_soup(context, source);
    TopologyCounter counter(context, source.info().n_vertices, ample_sort_bytes(context));
    for_triangle_batches(context, source,
                         [&](const TriangleBatch& batch) { counter.add(batch.corners); });
    return counter.finish();
}

}  // namespace hewer::streaming
