// SPDX-License-Identifier: MIT
/// What the doors of this room have to work with.
#pragma once

#include <cstdint>

#include "hewer/measure.h"
#include "ooc/context.h"

namespace hewer::measuring {

/// Of a window over the vertices of the original: more does not make a coherent file any faster.
constexpr std::uint64_t kMostWindowBytes = 128 << 20;

inline ooc::ResourceLimits limits_of(const MeasureOptions& options) {
    // Of spools. Not by the limit, or what a refusal names would not do.
    constexpr std::uint64_t kPageBytes = 64 << 10;
    return {.memory_bytes = options.memory_bytes,
            .n_threads = options.n_threads,
            .temp_dir = options.temp_dir,
            .max_temp_bytes = options.max_temp_bytes,
            .page_bytes = kPageBytes};
}

}  // namespace hewer::measuring
