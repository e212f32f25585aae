// SPDX-License-Identifier: MIT
#include "streaming/ordered_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "ooc/array.h"
#include "ooc/external_sort.h"
#include "streaming/equal_corners.h"

namespace hewer::streaming {

namespace {

using Points = std::array<Vec3, 3>;
using Take = std::function<void(std::span<const Points>)>;

constexpr std::uint64_t kResidentShare = 4;

bool is_degenerate(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

bool is_finite(const Points& corners) {
    return std::all_of(corners.begin(), corners.end(), [](const Vec3& p) {
        return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    });
}

std::optional<ooc::Array<Vec3>> load_positions(ooc::Context& context, MeshSource& source,
                                               std::uint64_t most_resident) {
    const std::uint64_t n = source.info().n_vertices;
    const std::uint64_t most = most_resident != 0
                                   ? most_resident
                                   : context.budget().limit() / kResidentShare / sizeof(Vec3);
    if (n > most) return {};
    std::optional<ooc::Array<Vec3>> positions = ooc::Array<Vec3>::try_make(context.budget(), n);
    if (!positions) return {};
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        VertexBatch batch;
        while (source.next_vertices(batch)) {
            std::copy(batch.positions.begin(), batch.positions.end(),
                      positions->begin() + batch.first);
            context.check_stop();
        }
    });
    return positions;
}

void stream_resident(ooc::Context& context, MeshSource& source, const ooc::Array<Vec3>& positions,
                     const Take& take) {
    std::vector<Points> piece;
    TriangleBatch batch;
    source.begin_triangles();
    while (source.next_triangles(batch)) {
        piece.clear();
        for (const Triangle& t : batch.corners) {
            const Points corners{positions[t[0]], positions[t[1]], positions[t[2]]};
            if (!is_degenerate(t) && is_finite(corners)) piece.push_back(corners);
        }
        take(piece);
        context.advance(batch.n_faces);
    }
}

/// A vertex, and the place of a corner that it is.
using WantedVertex = std::array<std::uint64_t, 2>;

struct FoundCorner {
    std::uint64_t number;
    Vec3 position;

    bool operator<(const FoundCorner& o) const { return number < o.number; }
};

using FoundCorners = ooc::ExternalSorter<FoundCorner, std::less<>>;

/// The positions of all corners, in the order of the vertices.
void find_positions(ooc::Context& context, MeshSource& source, FoundCorners& found) {
    ooc::ExternalSorter<WantedVertex, std::less<>> sorter(context, "corners by vertex", {},
                                                          ample_sort_bytes(context));
    std::uint64_t number = 0;
    TriangleBatch batch;
    source.begin_triangles();
    while (source.next_triangles(batch)) {
        for (const Triangle& t : batch.corners) {
            if (is_degenerate(t)) continue;
            for (const std::uint64_t v : t) sorter.add({v, number++});
        }
        context.check_stop();
    }
    ooc::Spool<WantedVertex> wanted = sorter.finish();
    ooc::SpoolReader<WantedVertex> reader(wanted);
    VertexBatch vertices;
    source.begin_vertices();
    while (source.next_vertices(vertices)) {
        const std::uint64_t end = vertices.first + vertices.positions.size();
        while (reader.peek() != nullptr && (*reader.peek())[0] < end) {
            const WantedVertex& corner = *reader.next();
            found.add({corner[1], vertices.positions[corner[0] - vertices.first]});
        }
        wanted.discard_before(reader.position());
        context.check_stop();
    }
}

void stream_joined(ooc::Context& context, MeshSource& source, const Take& take) {
    FoundCorners sorter(context, "corners by triangle", {}, ample_sort_bytes(context));
    find_positions(context, source, sorter);
    ooc::Spool<FoundCorner> corners = sorter.finish();
    ooc::SpoolReader<FoundCorner> reader(corners);
    constexpr std::size_t kPiece = 1 << 13;
    std::vector<Points> piece;
    while (reader.peek() != nullptr) {
        piece.clear();
        while (piece.size() < kPiece && reader.peek() != nullptr) {
            for (Vec3& p : piece.emplace_back()) p = reader.next()->position;
            if (!is_finite(piece.back())) piece.pop_back();
        }
        take(piece);
        corners.discard_before(reader.position());
        context.advance(piece.size());
    }
}

}  // namespace

void stream_points(ooc::Context& context, MeshSource& source, std::uint64_t most_resident,
                   const Take& take) {
    if (const auto positions = load_positions(context, source, most_resident)) {
        stream_resident(context, source, *positions, take);
    } else {
        stream_joined(context, source, take);
    }
}

}  // namespace hewer::streaming
