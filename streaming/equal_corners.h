// SPDX-License-Identifier: MIT
/// The corners of a triangle soup that lie in one place, found by sorting.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/context.h"
#include "ooc/external_sort.h"
#include "ooc/parallel.h"

namespace hewer::streaming {

/// Bytes for the buffer of a sort that has the run to itself: a 32nd of the limit.
inline std::uint64_t ample_sort_bytes(ooc::Context& context) {
    constexpr std::uint64_t kShare = 32;
    constexpr std::uint64_t kMostBuffers = 64;
    const std::uint64_t unit = context.sort_bytes();
    return unit *
           std::clamp<std::uint64_t>(context.budget().limit() / kShare / unit, 1, kMostBuffers);
}

/// Of corners by id or by place: two of them are the same.
template <typename Corner>
bool is_degenerate(const std::array<Corner, 3>& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// take(batch) for all triangles, one batch at a time, in any order, decoded on all threads.
template <typename Take>
void for_triangle_batches(ooc::Context& context, MeshSource& source, const Take& take) {
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

/// A corner of a soup. `number` rises with the triangles of the file, in threes: 3 * triangle + k,
/// with gaps where triangles are left out.
template <typename Real>
struct PlacedCorner {
    std::array<Real, 3> position;
    std::array<std::uint32_t, 2> halves;  // of its number: the record stays as small as it can be

    PlacedCorner() = default;
    PlacedCorner(const Vec3& p, std::uint64_t number)
        : position{},
          halves{static_cast<std::uint32_t>(number >> 32), static_cast<std::uint32_t>(number)} {
        // Plus zero: -0 becomes 0.
        for (std::size_t k = 0; k < 3; ++k) position[k] = static_cast<Real>(p[k]) + Real{0};
    }
    [[nodiscard]] std::uint64_t number() const {
        return std::uint64_t{halves[0]} << 32 | halves[1];
    }
    bool operator<(const PlacedCorner& o) const {
        return position != o.position ? position < o.position : number() < o.number();
    }
};

/// take(position, first, number) for each corner of `soup`, those of one place together and by
/// number; `first` is the lowest number of that place. Triangles with two corners in one place are
/// left out; they are among the defects that it returns.
/// Memory: a sorter's buffer. Disk, where memory is short: 20 bytes a corner, 32 with doubles.
template <typename Real, typename Take>
InputDefects for_equal_corners(ooc::Context& context, MeshSource& soup, const Take& take) {
    using Corner = PlacedCorner<Real>;
    ooc::ExternalSorter<Corner, std::less<>> by_position(context, "corners by position", {},
                                                         ample_sort_bytes(context));
    InputDefects defects;
    for_triangle_batches(context, soup, [&](const TriangleBatch& batch) {
        std::uint64_t number = 3 * batch.first_face;
        for (const auto& t : batch.points) {
            if (is_degenerate(t)) {
                ++defects.degenerate_triangles;
            } else {
                for (std::size_t k = 0; k < 3; ++k) by_position.add(Corner(t[k], number + k));
            }
            number += 3;
        }
        defects.merge(batch.defects);
    });
    auto placed = by_position.stream();
    std::array<Real, 3> place{};
    std::uint64_t first = 0;
    bool is_begun = false;
    while (const Corner* corner = placed.next()) {
        if (!is_begun || corner->position != place) {
            first = corner->number();
            place = corner->position;
            is_begun = true;
        }
        take(place, first, corner->number());
        constexpr std::uint64_t kBetween = 1 << 16;
        if (placed.n_left() % kBetween == 0) context.check_stop();
    }
    return defects;
}

}  // namespace hewer::streaming
