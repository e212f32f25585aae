// SPDX-License-Identifier: MIT
/// What is in a file.
#pragma once

#include <filesystem>

#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer {

/// Counts, bounds, attributes and defects of a mesh file: one pass over vertices and triangles.
/// Memory: bounded by the batches in flight; 12 bytes a vertex more, 24 if the file has double
/// positions, when they fit `memory_bytes`. They are for the surface area, for triangles without
/// area and for indexed triangles with a corner that is not finite; without them these stay zero,
/// and a warning says so. A triangle soup needs none of it.
/// Deterministic for any thread count.
/// Throws: FormatError, IoError, Cancelled, OutOfMemoryBudget (a limit below what the program
/// itself needs).
InputReport info(const std::filesystem::path& input, std::uint64_t memory_bytes = 0,
                 unsigned n_threads = 0, const Hooks& hooks = {});

}  // namespace hewer
