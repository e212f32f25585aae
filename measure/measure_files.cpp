// SPDX-License-Identifier: MIT
#include <memory>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/within.h"
#include "ooc/progress_part.h"

namespace hewer {

namespace {

/// body(original, simplified, hooks for the rest).
template <typename Body>
auto with_both(const InputPaths& original, const InputPaths& simplified,
               const MeasureOptions& options, const Hooks& hooks, const Body& body) {
    // Shares of the time of inputs that are imported, for progress.
    constexpr double kFrom = 0.1;
    constexpr double kTo = 0.15;
    const std::unique_ptr<MeshSource> from =
        open_mesh(original, opening(options), ooc::part_of(hooks, 0, kFrom));
    const std::unique_ptr<MeshSource> to =
        open_mesh(simplified, opening(options), ooc::part_of(hooks, kFrom, kTo));
    const bool is_imported = from->held_temp_bytes() + to->held_temp_bytes() > 0;
    return body(*from, *to, ooc::part_of(hooks, is_imported ? kTo : 0, 1));
}

}  // namespace

MeasureReport measure_files(const InputPaths& original, const InputPaths& simplified,
                            const MeasureOptions& options, const Hooks& hooks) {
    return with_both(original, simplified, options, hooks,
                     [&](MeshSource& from, MeshSource& to, const Hooks& rest) {
                         return measure(from, to, options, rest);
                     });
}

WithinReport prove_within_files(const InputPaths& original, const InputPaths& simplified,
                                double distance, const MeasureOptions& options,
                                const Hooks& hooks) {
    return with_both(original, simplified, options, hooks,
                     [&](MeshSource& from, MeshSource& to, const Hooks& rest) {
                         return prove_within(from, to, distance, options, rest);
                     });
}

}  // namespace hewer
