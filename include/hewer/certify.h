// SPDX-License-Identifier: MIT
/// Levels of detail with their distances from the input: measured, and not only bounded.
#pragma once

#include <filesystem>

#include "hewer/options.h"
#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer {

/// simplify_file(), then measure_files() on each output: LodReport::measured. The outputs are read
/// again: what their formats round is measured, too.
/// Throws what both of them throw; the outputs are there if it was the measuring that failed.
SimplifyReport simplify_and_measure(const InputPaths& input, const std::filesystem::path& output,
                                    const SimplifyOptions& options, const Hooks& hooks = {},
                                    bool overwrite = false);

/// The smallest level of detail found that is within options.targets[0] of the input, both ways:
/// one target, of kind Error or RelativeError. Budgets are tried, each measured and those that pass
/// proven by prove_within(), until the smallest good one is within some 4 % of one that is not.
/// Within each run the places that are farther than the bound get more of the budget (feedback); a
/// result that fails in a few places is repaired there: these are pulled to the input, and it is
/// proven again. SimplifyReport::search has the tries and rounds of repairs,
/// LodReport::proven_within what is proven: 0 where that took too many pieces, and the distance is
/// measured only, at all vertices and at samples of both surfaces. Repairs are after all that the
/// report says of collapses, fit, and folded faces. The displacement that simplify() bounds for
/// such targets is not what is searched for here.
///
/// Passes: up to fourteen runs of simplify() and measure(), mostly four to six, and for each up to
/// 24 proofs. Memory: theirs, and 48 bytes for each triangle of the best result and of the try at
/// hand. Throws: what simplify(), measure() and prove_within() throw; InvalidArgument if no budget
/// is good enough, or with quantisation, which would come on top.
SimplifyReport simplify_to_distance(const InputPaths& input, const std::filesystem::path& output,
                                    const SimplifyOptions& options, const Hooks& hooks = {},
                                    bool overwrite = false);

}  // namespace hewer
