// SPDX-License-Identifier: MIT
/// Progress of a step that is a part of a longer run.
#pragma once

#include "hewer/progress.h"

namespace hewer::ooc {

/// `hooks` for a step that takes the run from fraction `from` to `to`. The time left of the step
/// is not that of the run, so it is not told.
inline Hooks part_of(const Hooks& hooks, double from, double to) {
    Hooks part = hooks;
    if (!hooks.on_progress || (from == 0 && to == 1)) return part;
    part.on_progress = [call = hooks.on_progress, from, to](const Progress& step) {
        Progress whole = step;
        whole.fraction = from + (to - from) * step.fraction;
        whole.remaining_seconds = -1;
        call(whole);
    };
    return part;
}

}  // namespace hewer::ooc
