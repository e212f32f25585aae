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
/// Within each run the places that are farther than the bound get more of the budget (feedback);
/// where a budget fails in a few places, it is tried again with more weight on these.
/// SimplifyReport::search has the tries, LodReport::proven_within what is proven: 0 where that took
/// too many pieces, and the distance is measured only, at all vertices and at samples of both
/// surfaces. The displacement that simplify() bounds for such targets is not what is searched for
/// here.
///
/// Passes: some ten to forty runs of simplify() and measure(). Memory: theirs, and 46 bytes
/// for each triangle of the result and of the one or two tries at hand. Throws: what simplify(),
/// measure() and prove_within() throw; InvalidArgument if no budget is good enough, or with
/// quantisation, which would come on top.
SimplifyReport simplify_to_distance(const InputPaths& input, const std::filesystem::path& output,
                                    const SimplifyOptions& options, const Hooks& hooks = {},
                                    bool overwrite = false);

}  // namespace hewer
