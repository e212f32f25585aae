// SPDX-License-Identifier: MIT
/// A level of detail that is too far in a few places, made good there.
#pragma once

#include <cstdint>
#include <functional>

#include "fidelity/judge.h"
#include "fidelity/kept_mesh.h"
#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer::fidelity {

/// The maximum of a distance belongs to a few places, and another run with as many triangles moves
/// them rather than that it removes them. So where a level fails in places only (failing_places.h),
/// these are pulled to the original (pull_to_points.h), what has changed is proven against what of
/// the original is near it (neighbourhood.h), and places that are left or new are pulled again:
/// mostly a matter of milliseconds. When none is left, the whole level is proven, or more places
/// are named. All of it in up to 64 rounds; not for much longer than the number of places shrinks,
/// and while the level has at most 3 % more triangles than before.
///
/// `lod` has been measured, is kept up to date, and is proven in the end or not. Triangles of `lod`
/// are about `spacing` long. `on_round` is told of each round's result. Passes over the original:
/// for most rounds none, one where a repair comes to other places, and those of the proofs. True:
/// the mesh has changed.
bool repair(const Judge& judge, double bound, double spacing, KeptMesh& mesh, LodReport& lod,
            const Hooks& hooks, const std::function<void(const LodReport&)>& on_round);

}  // namespace hewer::fidelity
