// SPDX-License-Identifier: MIT
#include "measure/nearest_surface.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "hewer/error.h"
#include "measure/census.h"
#include "measure/resident_surface.h"

namespace hewer::measuring {

NearestSurface::NearestSurface(ooc::Context& context, MeshSource& surface, const Bounds& box) {
    const Census census = take_census(context, surface, context.budget().available() / 4);
    if (census.n_triangles == 0) {
        throw InvalidArgument(surface.info().name + ": has no triangle with finite corners");
    }
    Bounds both = census.bounds;
    both.extend(box);
    lattice_ = Lattice(both);
    ResidentSurface resident = load_surface(context, surface, census, lattice_);
    resident.points.release();
    index_ = TriangleIndex(context, std::move(resident.triangles), census.n_triangles);
}

NearestSurface::Found NearestSurface::Stream::nearest(const Vec3& p) {
    const Lattice& lattice = surface_->lattice_;
    const TriangleIndex::Nearest nearest = walk_.nearest(to_double(lattice.from_model(p)));
    Found found{std::sqrt(nearest.squared_distance) * lattice.step(), nearest.triangle, {}};
    const LatticeTriangle& t = surface_->index_.triangles()[nearest.triangle];
    for (std::size_t c = 0; c < 3; ++c) found.corners[c] = lattice.to_model(to_double(t[c]));
    return found;
}

}  // namespace hewer::measuring
