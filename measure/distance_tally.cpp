// SPDX-License-Identifier: MIT
#include "measure/distance_tally.h"

namespace hewer::measuring {

double DistanceHistogram::quantile(double share) const {
    std::uint64_t n = 0;
    for (const std::uint64_t count : counts_) n += count;
    const double wanted = share * static_cast<double>(n);
    double seen = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        const auto count = static_cast<double>(counts_[i]);
        if (count > 0 && seen + count >= wanted) {
            if (i == 0) return 0;  // zero, or next to it
            const double lower = upper_edge(i - 1);
            return lower + (wanted - seen) / count * (upper_edge(i) - lower);
        }
        seen += count;
    }
    return 0;
}

}  // namespace hewer::measuring
