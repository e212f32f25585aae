// SPDX-License-Identifier: MIT
/// How far two surfaces are apart: the two-sided distance that Metro made customary.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer {

struct MeasureOptions {
    /// Samples on each surface besides its vertices, spread by area. 0: as many as the surface has
    /// triangles, at least 500'000 and at most 10'000'000.
    std::uint64_t n_samples = 0;
    std::uint64_t seed = 1;
    std::uint64_t memory_bytes = 0;  ///< as in SimplifyOptions
    unsigned n_threads = 0;
};

/// Distances from points of one surface to the other surface, model units.
struct DistanceReport {
    double maximum =
        0;  ///< of vertices and samples: a lower estimate of the one-sided Hausdorff distance
    double mean = 0;  ///< of the area-weighted samples
    double rms = 0;   ///< of the area-weighted samples
    double vertex_maximum = 0;
    double vertex_mean = 0;
    double vertex_rms = 0;
    std::uint64_t n_vertices =
        0;  ///< all vertices of the surface that belong to a face, measured exactly
    std::uint64_t n_samples = 0;
    Vec3 worst{};  ///< the point where the maximum was met
};

struct MeasureReport {
    DistanceReport forward;   ///< from the original to the simplified surface
    DistanceReport backward;  ///< from the simplified to the original surface
    Bounds bounds;            ///< of the original
    std::uint64_t original_triangles = 0;
    std::uint64_t simplified_triangles = 0;
    double seconds = 0;
    std::uint64_t peak_resident_bytes = 0;
};

/// Exact point-to-triangle distances, both ways. Deterministic for any thread count.
/// Throws: FormatError, IoError, OutOfMemoryBudget, Cancelled, InvalidArgument (a mesh without
/// triangles).
MeasureReport measure(MeshSource& original, MeshSource& simplified,
                      const MeasureOptions& options = {}, const Hooks& hooks = {});

MeasureReport measure_files(const std::filesystem::path& original,
                            const std::filesystem::path& simplified,
                            const MeasureOptions& options = {}, const Hooks& hooks = {});

}  // namespace hewer
