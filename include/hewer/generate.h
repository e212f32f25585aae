// SPDX-License-Identifier: MIT
/// Test data of any size: a closed, scan-like surface written as a stream.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hewer/progress.h"

namespace hewer {

struct GenerateOptions {
    std::uint64_t n_triangles =
        1'000'000;  ///< met within one row of the surface's own grid, never above
    std::uint64_t seed = 1;
    bool shuffle =
        false;  ///< vertices and faces in a pseudo-random order, still without holding them
    bool holes = false;  ///< open borders of several sizes, ragged as a scanner leaves them
    bool color = false;  ///< 8-bit vertex colours
    unsigned n_threads = 0;
    bool overwrite = false;
};

struct GenerateReport {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    std::uint64_t bytes = 0;
    double seconds = 0;
};

/// Writes binary little-endian PLY (float positions, `list uchar int` faces; `uint` from 2^31
/// vertices on). The surface: a rounded body with relief on several scales, ridges, sharp creases,
/// and scan noise; without `holes` it is closed and manifold, with them about 3 % of the triangles
/// are missing and the report has the true counts. Equal options give equal bytes for any thread
/// count. Memory: 1.7 MB a thread, with holes 8 bytes per 4096 vertices more.
/// Throws: IoError; Cancelled; InvalidArgument (fewer than 12 triangles, more than 2^32 vertices,
/// `shuffle` together with `holes`).
GenerateReport generate(const std::filesystem::path& output, const GenerateOptions& options,
                        const Hooks& hooks = {});

}  // namespace hewer
