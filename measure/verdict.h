// SPDX-License-Identifier: MIT
/// How a proof has ended that has looked at everything.
#pragma once

#include "hewer/measure.h"
#include "hewer/within.h"
#include "measure/far_places.h"
#include "measure/lattice.h"

namespace hewer::measuring {

/// Proven where no place is far; else refuted, and the worst places.
inline void set_verdict(WithinReport& report, const FarPlaces& forward, const FarPlaces& backward,
                        const Lattice& lattice, const MeasureOptions& options) {
    report.verdict = forward.empty() && backward.empty() ? WithinReport::Verdict::Proven
                                                         : WithinReport::Verdict::Refuted;
    report.forward = forward.report(lattice, options.most_places);
    report.backward = backward.report(lattice, options.most_places);
}

}  // namespace hewer::measuring
