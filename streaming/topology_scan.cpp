// SPDX-License-Identifier: MIT
#include "streaming/topology_scan.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "ooc/external_sort.h"
#include "ooc/parallel.h"
#include "streaming/topology_counter.h"

namespace hewer::streaming {

namespace {

std::uint64_t sort_bytes(ooc::Context& context) {
    constexpr std::uint64_t kShare = 32;
    constexpr std::uint64_t kMostBuffers = 64;
    const std::uint64_t unit = context.sort_bytes();
    return unit *
           std::clamp<std::uint64_t>(context.budget().limit() / kShare / unit, 1, kMostBuffers);
}

/// take(batch) for all triangles, one at a time.
template <typename Take>
void read_triangles(ooc::Context& context, MeshSource& source, const Take& take) {
    std::mutex mutex;
    source.begin_triangles();
    context.workers().on_each([&](unsigned) {
        TriangleBatch batch;
        while (source.next_triangles(batch)) {
            {
                const std::lock_guard lock(mutex);
                take(batch);
            }
            context.advance(batch.n_faces);
        }
    });
}

template <typename Real>
struct PlacedCorner {
    std::array<Real, 3> position;
    std::array<std::uint32_t, 2> number;  // halves: the record stays as small as it can be

    bool operator<(const PlacedCorner& o) const {
        return position != o.position ? position < o.position : number < o.number;
    }
    static PlacedCorner make(const Vec3& p, std::uint64_t number) {
        PlacedCorner corner{
            {}, {static_cast<std::uint32_t>(number >> 32), static_cast<std::uint32_t>(number)}};
        // Plus zero: -0 becomes 0.
        for (std::size_t k = 0; k < 3; ++k) corner.position[k] = static_cast<Real>(p[k]) + Real{0};
        return corner;
    }
};

/// A corner of the soup, and the vertex that it becomes.
using NumberedCorner = std::array<std::uint64_t, 2>;

/// Corners in the order of the triangles. Sorting by position tells which are equal, sorting by
/// number brings them back together.
template <typename Real>
ooc::Spool<NumberedCorner> number_vertices(ooc::Context& context, MeshSource& source,
                                           std::uint64_t& n_vertices) {
    using Corner = PlacedCorner<Real>;
    ooc::ExternalSorter<Corner, std::less<>> by_position(context, "corners by position", {},
                                                         sort_bytes(context));
    std::uint64_t n_corners = 0;
    read_triangles(context, source, [&](const TriangleBatch& batch) {
        for (const auto& triangle : batch.points) {
            for (const Vec3& p : triangle) by_position.add(Corner::make(p, n_corners++));
        }
    });
    ooc::ExternalSorter<NumberedCorner, std::less<>> by_number(context, "corners by triangle", {},
                                                               sort_bytes(context));
    n_vertices = 0;
    std::array<Real, 3> last{};
    {
        ooc::Spool<Corner> placed = by_position.finish();
        ooc::SpoolReader<Corner> reader(placed);
        while (const Corner* corner = reader.next()) {
            if (n_vertices == 0 || corner->position != last) ++n_vertices;
            last = corner->position;
            by_number.add(
                {std::uint64_t{corner->number[0]} << 32 | corner->number[1], n_vertices - 1});
            constexpr std::uint64_t kBetween = 1 << 16;
            if (reader.position() % kBetween == 0) {
                placed.discard_before(reader.position());
                context.check_stop();
            }
        }
    }
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
    TopologyCounter counter(context, n_vertices, sort_bytes(context));
    add_triangles(context, std::move(corners), counter);
    return counter.finish();
}

}  // namespace

TopologyReport count_topology(ooc::Context& context, MeshSource& source) {
    if (!source.info().is_indexed) return count_soup(context, source);
    TopologyCounter counter(context, source.info().n_vertices, sort_bytes(context));
    read_triangles(context, source,
                   [&](const TriangleBatch& batch) { counter.add(batch.corners); });
    return counter.finish();
}

}  // namespace hewer::streaming
