// SPDX-License-Identifier: MIT
#include <memory>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "ooc/progress_part.h"

namespace hewer {

MeasureReport measure_files(const InputPaths& original, const InputPaths& simplified,
                            const MeasureOptions& options, const Hooks& hooks) {
    // Shares of the time of inputs that are imported, for progress.
    constexpr double kFrom = 0.1;
    constexpr double kTo = 0.15;
    const std::unique_ptr<MeshSource> from =
        open_mesh(original, opening(options), ooc::part_of(hooks, 0, kFrom));
    const std::unique_ptr<MeshSource> to =
        open_mesh(simplified, opening(options), ooc::part_of(hooks, kFrom, kTo));
    const bool is_imported = from->held_temp_bytes() + to->held_temp_bytes() > 0;
    return measure(*from, *to, options, ooc::part_of(hooks, is_imported ? kTo : 0, 1));
}

}  // namespace hewer
