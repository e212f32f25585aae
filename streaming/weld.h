// SPDX-License-Identifier: MIT
/// A triangle soup with vertices and indices.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "hewer/mesh_source.h"
#include "hewer/types.h"
#include "ooc/context.h"
#include "ooc/external_sort.h"
#include "ooc/ranked_set.h"

namespace hewer::streaming {

/// Makes one vertex of all corners with exactly the same position (-0 equals 0). Vertices have the
/// order in which the triangles use them first; triangles that of the file, without those that have
/// two corners in one place.
///
/// Passes over the triangles of `soup`: one at once, and one for each for_vertices(). Memory:
/// bytes(), and the buffers of two sorters. Disk, where memory is short: 60 bytes a
/// triangle (96 with double positions), of which half is given back as 48 more come.
/// Throws: as the source does, OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
class Weld {
  public:
    /// Besides the buffers.
    static constexpr std::uint64_t bytes(std::uint64_t n_triangles) {
        return n_triangles / 64 * 27 + 128;
    }

    Weld(ooc::Context& context, MeshSource& soup);

    [[nodiscard]] std::uint64_t n_vertices() const { return n_vertices_; }
    [[nodiscard]] std::uint64_t n_triangles() const { return n_triangles_; }
    [[nodiscard]] const Bounds& bounds() const { return bounds_; }
    /// Those of the source, and the triangles that are left out.
    [[nodiscard]] const InputDefects& defects() const { return defects_; }

    /// take(positions), piece by piece.
    void for_vertices(const std::function<void(std::span<const Vec3>)>& take);
    /// take(triangles), piece by piece. Once.
    void for_triangles(const std::function<void(std::span<const Triangle>)>& take);

  private:
    /// A corner of the file, and the first one in its place.
    struct WeldedCorner {
        std::uint64_t number;
        std::uint64_t first;

        bool operator<(const WeldedCorner& o) const { return number < o.number; }
    };

    template <typename Real>
    void weld();

    ooc::Context& context_;
    MeshSource& soup_;
    ooc::RankedSet firsts_;  // corners that are the first in their place
    ooc::ExternalSorter<WeldedCorner, std::less<>> by_number_;
    std::uint64_t n_vertices_ = 0;
    std::uint64_t n_triangles_ = 0;
    Bounds bounds_;
    InputDefects defects_;
};

}  // namespace hewer::streaming
