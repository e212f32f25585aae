// SPDX-License-Identifier: MIT
/// What a run would need, told from the header and a small sample, before any work.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hewer/options.h"
#include "hewer/report.h"

namespace hewer {

/// All figures are estimates except those that the header gives.
struct PlanReport {
    InputReport input;  ///< counts from the header; bounds and area from the sample
    double cell_size = 0;
    std::uint64_t cells = 0;
    std::uint64_t surviving_triangles = 0;
    std::uint64_t target_triangles = 0;
    std::uint64_t memory_bytes = 0;        ///< peak of the whole process under that limit
    std::uint64_t memory_limit_bytes = 0;  ///< that would apply
    std::uint64_t least_memory_bytes = 0;  ///< a limit below this is refused
    bool fits = true;                      ///< least_memory_bytes <= memory_limit_bytes
    std::uint64_t temp_bytes = 0;          ///< most temporary disk space at once
    std::uint64_t bytes_read = 0;
    std::uint64_t bytes_written = 0;
    double seconds = 0;
};

/// Reads the header and a sample of the input; of one that has to be imported (see OpenOptions),
/// all. Throws as simplify() does.
PlanReport plan(const InputPaths& input, const SimplifyOptions& options);

}  // namespace hewer
