// SPDX-License-Identifier: MIT
/// The nearest triangle of a surface for a stream of points: this room's door for other rooms.
#pragma once

#include <array>
#include <cstdint>

#include "hewer/mesh_source.h"
#include "hewer/types.h"
#include "measure/lattice.h"
#include "measure/triangle_index.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// A surface in memory that any number of points may stream past. Distances are exact but for the
/// lattice (see there): 5e-10 of the extent.
///
/// Memory: 43 bytes a triangle; while it is made 12 bytes a vertex besides (a soup: 36 bytes a
/// triangle). The points need none.
class NearestSurface {
  public:
    /// Reads `surface` twice: its triangles to find its box, vertices and triangles to load them.
    /// `box` holds the points to come; one outside of it and of the surface's own box is moved into
    /// the next corner of both.
    /// Throws: InvalidArgument (no triangle with finite corners), FormatError, IoError,
    /// OutOfMemoryBudget, OutOfDiskBudget, Cancelled.
    NearestSurface(ooc::Context& context, MeshSource& surface, const Bounds& box);

    struct Found {
        double distance = 0;            ///< model units
        std::uint64_t triangle = 0;     ///< a number of its own: equal for equal triangles
        std::array<Vec3, 3> corners{};  ///< of the triangle
    };
    /// One thread's points, most of them near the one before. The surface must outlive it.
    class Stream {
      public:
        explicit Stream(const NearestSurface& surface)
            : surface_(&surface), walk_(surface.index_) {}
        /// Of several triangles at the same distance the same one whatever came before.
        Found nearest(const Vec3& p);

      private:
        const NearestSurface* surface_;
        TriangleIndex::Walk walk_;
    };

    [[nodiscard]] std::uint64_t n_triangles() const { return index_.triangles().size(); }

  private:
    Lattice lattice_;
    TriangleIndex index_;
};

}  // namespace hewer::measuring
