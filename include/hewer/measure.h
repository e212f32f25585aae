// SPDX-License-Identifier: MIT
/// How far two surfaces are apart: the two-sided distance that Metro made customary.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer {

/// Which surface a distance map shows.
enum class MapOf {
    /// Each vertex in the colour of its distance, or of the farthest point of the original for
    /// which
    /// one of its triangles is the nearest, if that is farther: so what the simplified surface has
    /// lost shows where it was lost.
    Simplified,
    /// Each vertex in the colour of its distance to the simplified surface.
    Original,
};

struct MeasureOptions {
    /// About so many samples on each surface besides its vertices, spread by area. 0:
    /// default_samples() of its triangles.
    std::uint64_t n_samples = 0;
    std::uint64_t seed = 1;
    unsigned most_places = 10;  ///< in DistanceReport::worst
    /// How far from each other those of a proof are (hewer/within.h), about; of the diagonal.
    double places_apart = 0.05;
    /// A mesh file to write (see MeshSink), its vertices coloured by distance; empty: none.
    std::filesystem::path map{};
    MapOf map_of = MapOf::Simplified;
    /// Distance of the last colour of the map, model units; 0: the larger 99.9 % quantile of both
    /// directions.
    double map_range = 0;
    /// Of the input; see OpenOptions::format.
    std::string input_format{};
    bool overwrite = false;          ///< the map
    std::uint64_t memory_bytes = 0;  ///< as in SimplifyOptions
    unsigned n_threads = 0;
    std::filesystem::path temp_dir{};  ///< for what does not fit: empty: TMPDIR, else /tmp
    std::uint64_t max_temp_bytes = 0;  ///< 0: no limit
};

/// As many as a surface has triangles, at least 500'000 and at most 10'000'000.
std::uint64_t default_samples(std::uint64_t n_triangles);

/// `n` of the samples are at `from` or farther, and nearer than `to`; model units.
struct DistanceBin {
    double from = 0;
    double to = 0;
    std::uint64_t n = 0;
};

/// A share of the samples is at this distance or nearer, to within 3.1 % of it.
struct DistanceQuantile {
    double share = 0;
    double distance = 0;
};

struct WorstPlace {
    Vec3 point{};
    double distance = 0;
};

/// Distances from points of one surface to the other surface, model units. Each distance is exact,
/// to the nearest point of any triangle; what is sampled is where they are taken.
struct DistanceReport {
    double maximum =
        0;  ///< of vertices and samples: a lower estimate of the one-sided Hausdorff distance
    double mean = 0;  ///< of the area-weighted samples
    double rms = 0;   ///< of the area-weighted samples
    double vertex_maximum = 0;
    double vertex_mean = 0;
    double vertex_rms = 0;
    /// All vertices of the surface that belong to a triangle are measured. A soup has no vertices:
    /// equal corners are taken for one.
    std::uint64_t n_vertices = 0;
    std::uint64_t n_samples = 0;
    std::vector<DistanceQuantile> quantiles;  ///< of 50, 90, 99 and 99.9 % of the samples
    /// Of the samples, by doublings of 2^-40 of the diagonal; from the first bin that is not empty
    /// to the last.
    std::vector<DistanceBin> histogram;
    /// The MeasureOptions::most_places worst points, worst first, no two within 5 % of the
    /// diagonal; fewer if the surfaces are small or alike.
    std::vector<WorstPlace> worst;
};

struct MeasureReport {
    DistanceReport forward;   ///< from the original to the simplified surface
    DistanceReport backward;  ///< from the simplified to the original surface
    Bounds bounds;            ///< of the original
    std::uint64_t original_triangles = 0;
    std::uint64_t simplified_triangles = 0;
    double map_range = 0;  ///< distance of the map's last colour; 0: no map
    double seconds = 0;
    std::uint64_t temp_bytes_written = 0;
    std::uint64_t peak_resident_bytes = 0;
};

/// Point-to-triangle distances, both ways. Equal bits for any thread count and memory limit.
///
/// The original is never in memory: it streams past the simplified surface three times. Memory: 140
/// bytes a triangle of the simplified surface (with as many samples as triangles), a bit for each
/// vertex of the original, and a window over its vertices. Disk: for an original that is a soup, or
/// whose triangles are in no order (see docs/measure.md). A limit that is too small is refused
/// before the original is read, with the number that would do.
/// Throws: FormatError, IoError, OutOfMemoryBudget, OutOfDiskBudget, Cancelled, InvalidArgument (a
/// mesh without triangles).
MeasureReport measure(MeshSource& original, MeshSource& simplified,
                      const MeasureOptions& options = {}, const Hooks& hooks = {});

MeasureReport measure_files(const InputPaths& original, const InputPaths& simplified,
                            const MeasureOptions& options = {}, const Hooks& hooks = {});

}  // namespace hewer
