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
/// these are pulled to the original (pull_to_points.h) and the level is judged again, in up to 24
/// rounds; not for much longer than the number of places shrinks, and while it has at most 3 % more
/// triangles than before.
///
/// `lod` has been measured, is kept up to date, and is proven in the end or not. `on_round` is told
/// of each round's result. Each round has a proof, and a pass over the original for what is nearest
/// to places of the level. True: the mesh has changed.
bool repair(const Judge& judge, double bound, KeptMesh& mesh, LodReport& lod, const Hooks& hooks,
            const std::function<void(const LodReport&)>& on_round);

}  // namespace hewer::fidelity
