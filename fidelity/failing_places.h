// SPDX-License-Identifier: MIT
/// Where a level of detail is too far from its original though nearly all of it is near enough.
#pragma once

#include <vector>

#include "hewer/measure.h"
#include "hewer/options.h"

namespace hewer::fidelity {

/// Whether what is farther than `bound` are places, and not the surface at large: 99.9 % of both
/// surfaces are clearly nearer. More of the budget for the places may do then.
bool fails_in_places(const MeasureReport& measured, double bound);

/// Boxes around the worst places of both directions, those that fail and those that are about to.
/// The triangles there are `spacing` long. A place that fails again gets a second box, and so more
/// weight. Boxes are small: what they get is missing elsewhere.
void focus_on_failures(const MeasureReport& measured, double bound, double spacing,
                       std::vector<FocusBox>& focus);

}  // namespace hewer::fidelity
