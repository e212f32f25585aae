// SPDX-License-Identifier: MIT
/// What is in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer {

struct InfoOptions {
    static constexpr std::uint64_t kWholeBelow = 64 << 20;

    /// Inputs of up to so many bytes are read whole, what is compressed counted four times; so are
    /// pipes, and all inputs with `with_topology`. Of larger ones the report has what their headers
    /// say, or a sample: InputReport::basis.
    std::uint64_t whole_below = kWholeBelow;
    /// Count borders, components and what is not manifold as well: one pass more over the
    /// triangles, and 4 bytes a vertex of memory (8 beyond 2^32 vertices), the rest on disk where
    /// it has to be. The vertices of a triangle soup are its exactly equal corners.
    bool with_topology = false;
    /// Of the input; see OpenOptions::format.
    std::string input_format{};
    /// As in SimplifyOptions.
    std::uint64_t memory_bytes = 0;
    unsigned n_threads = 0;
    std::filesystem::path temp_dir{};
    std::uint64_t max_temp_bytes = 0;
};

/// Counts, bounds, attributes and defects of a mesh file: from its beginning in well under a second
/// if it is large, else by one pass over vertices and triangles.
/// Memory: bounded by the batches in flight; 12 bytes a vertex more, 24 if the file has double
/// positions, when they fit `memory_bytes`. They are for the surface area, for triangles without
/// area and for indexed triangles with a corner that is not finite; without them these stay zero,
/// and a warning says so. A triangle soup needs none of it.
/// Deterministic for any thread count.
/// Throws: FormatError, IoError, Cancelled, OutOfMemoryBudget (a limit below what the program
/// itself, or the topology, needs), OutOfDiskBudget.
InputReport info(const InputPaths& input, const InfoOptions& options = {}, const Hooks& hooks = {});

}  // namespace hewer
