// SPDX-License-Identifier: MIT
#include "measure/distance_tally.h"

namespace hewer::measuring {

double DistanceHistogram::quantile(double share) const {
    std::uint64_t n = 0;
    for (const std::uint64_t count : counts_) n += count;
    const double wanted = share * static_cast<double>(n);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        seen += counts_[i];
        if (counts_[i] != 0 && static_cast<double>(seen) >= wanted) {
            return i == 0 ? 0 : upper_edge(i);
        }
    }
    return 0;
}

}  // namespace hewer::measuring
