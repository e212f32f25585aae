// SPDX-License-Identifier: MIT
/// What is in a file.
#pragma once

#include <filesystem>

#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer {

/// Counts, bounds, attributes and defects of a mesh file: one pass over vertices and triangles.
/// Memory: bounded by the batches in flight (12 bytes a vertex more when it fits `memory_bytes`, to
/// find zero-area triangles and the surface area; else these two are left at zero).
/// Throws: FormatError, IoError, Cancelled.
InputReport info(const std::filesystem::path& input, std::uint64_t memory_bytes = 0,
                 unsigned n_threads = 0, const Hooks& hooks = {});

}  // namespace hewer
