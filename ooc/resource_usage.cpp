// SPDX-License-Identifier: MIT
#include "ooc/resource_usage.h"

#include <sys/resource.h>

namespace hewer::ooc {

std::uint64_t peak_resident_bytes() {
    rusage usage{};
    if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

}  // namespace hewer::ooc
