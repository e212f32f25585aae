// SPDX-License-Identifier: MIT
/// What a run tells about itself. Every number is counted or measured, none is an estimate unless
/// its comment says so. app/report_json writes these fields under these names.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"
#include "hewer/types.h"

namespace hewer {

/// One stage of the pipeline: "bounds", "cluster", "refine", "finish", "write", ...
struct StageReport {
    std::string name;
    double seconds = 0;
    std::uint64_t bytes_read = 0;
    std::uint64_t bytes_written = 0;
    std::uint64_t temp_bytes_read = 0;  ///< of temporary files
    std::uint64_t temp_bytes_written = 0;
    std::uint64_t peak_budget_bytes = 0;    ///< most that was reserved at once during the stage
    std::uint64_t peak_resident_bytes = 0;  ///< of the process so far, as the system counts it
};

/// A triangle mesh by its indices, as a reader of the file sees it; faces with a repeated corner
/// and vertices without a face do not count.
struct TopologyReport {
    std::uint64_t components = 0;
    std::uint64_t border_edges = 0;          ///< one face
    std::uint64_t border_loops = 0;          ///< of these; loops that share a vertex are one
    std::uint64_t nonmanifold_edges = 0;     ///< more than two faces
    std::uint64_t nonmanifold_vertices = 0;  ///< at such an edge, or their faces form several fans
    std::int64_t euler = 0;                  ///< vertices - edges + faces
};

struct InputReport {
    /// Where the figures are from, the weakest last.
    enum class Basis {
        Whole,   ///< everything was read
        Header,  ///< counts and attributes are the file's own claim, polygons counted as triangles;
                 ///< bounds are what it claims or those of a sample, empty if there is neither;
                 ///< area and defects are not known
        Sample,  ///< all are estimates, from pieces of the file
        Name,    ///< only the format is known
    };

    std::string path;
    std::string format;
    std::uint64_t bytes = 0;
    double opening_seconds = 0;   ///< for what is imported or unpacked first; part of the run's
    std::uint64_t vertices = 0;   ///< 0 for a soup
    std::uint64_t faces = 0;      ///< as the file has them
    std::uint64_t triangles = 0;  ///< after fanning polygons, dropped ones not counted
    Bounds bounds;
    bool has_normals = false;
    bool has_colors = false;
    bool has_weights = false;
    std::vector<TextureInfo> textures;  ///< that colours were sampled from
    std::vector<std::string> ignored;
    InputDefects defects;
    double area = 0;  ///< of all triangles, square model units; 0 with Method::Copy
    Basis basis = Basis::Whole;
    int vertex_passes = 0;
    int triangle_passes = 0;
    std::optional<TopologyReport> topology;  ///< where it was asked for; of a soup by positions
};

struct GridReport {
    double cell_size = 0;                       ///< model units
    std::array<std::uint64_t, 3> dimensions{};  ///< cells an axis
    std::uint64_t occupied_cells = 0;
    std::uint64_t border_cells = 0;         ///< with a border that does not cancel
    std::uint64_t surviving_triangles = 0;  ///< corners in three different cells
    bool is_consistently_wound = true;      ///< false: border quadrics were left out
};

/// Places of the input that a first LOD was far from, before the budget was shared out again.
struct FeedbackReport {
    unsigned rounds = 0;
    std::uint64_t far_cells = 0;  ///< in the last round
    double first_worst = 0;       ///< largest distance found in the first round, model units
    double last_worst = 0;        ///< the same in the last one
};

/// How far the vertices of an LOD were moved towards the original surface, after the collapse.
struct FitReport {
    unsigned rounds = 0;
    double first_move = 0;  ///< root mean square over the vertices in the first round, model units
    double last_move = 0;   ///< the same in the last one
    /// Root mean square of the distances of the samples before the last round, of those that pull.
    double distance = 0;
    std::uint64_t held = 0;   ///< vertices that were not let in the last round, borders included
    std::uint64_t flips = 0;  ///< edges that were flipped, all rounds
};

/// A place where a part of the surface went missing.
struct LostPlace {
    Vec3 center{};
    double size = 0;          ///< diagonal of its box, model units
    std::uint64_t cells = 0;  ///< of the grid
};

/// Parts of which no triangle is left; those that touch are one place.
struct LostPlaces {
    static constexpr std::size_t kMostListed = 10'000;

    std::uint64_t places = 0;
    std::uint64_t cells = 0;
    std::vector<LostPlace> list;  ///< the largest, by size, then place
};

/// A face that shows the surface it stands for its back.
struct FoldedFace {
    Vec3 center{};
    double size = 0;  ///< its longest edge, model units
};

/// Faces turned by more than 90 degrees from all of the input's surface that is near them.
struct FoldedFaces {
    static constexpr std::size_t kMostListed = 100;

    std::uint64_t faces = 0;
    std::uint64_t unfolded = 0;    ///< that were, before vertices were moved to turn them back
    std::vector<FoldedFace> list;  ///< the largest, by size, then place
};

/// A budget that simplify_to_distance() tried, or what a round of repairs made of its result.
struct SearchStep {
    std::uint64_t triangles = 0;
    /// The larger of both directions, model units: measured, or after a round that did not do at
    /// least what the proof says of the worst place.
    double distance = 0;
};

struct LodReport {
    std::string path;
    Target target;
    std::uint64_t target_triangles =
        0;  ///< what the target came to; 0 for error and vertex targets
    std::uint64_t triangles = 0;
    std::uint64_t vertices = 0;
    Bounds bounds;
    /// No original vertex is farther than this from the vertex that stands for it (model units),
    /// bar those counted in `lost_cells`. A bound on the distance from the LOD to the original and,
    /// where nothing was lost, from the original to the LOD. What the format rounds is in it.
    double error_bound = 0;
    double quantization = 0;  ///< most that quantised positions have moved by; part of the bound
    std::uint64_t lost_cells = 0;  ///< grid cells whose whole surface collapsed away (tiny parts)
    LostPlaces lost;               ///< where; with parts that fell between the cells
    FitReport fit;
    std::optional<FoldedFaces> folded;  ///< not counted with Method::Uniform
    TopologyReport topology;
    std::optional<MeasureReport> measured;  ///< by the functions of hewer/certify.h
    /// No point of either surface, input or LOD, is farther than this from the other one; 0 if that
    /// was not asked for or could not be shown. By simplify_to_distance().
    double proven_within = 0;
    bool is_nested = true;  ///< every vertex of the next finer LOD has one parent here
    std::uint64_t bytes = 0;
};

/// Parts of the model that SimplifyOptions::aggregate has joined.
struct AggregateReport {
    std::uint64_t parts = 0;         ///< of the grid, before
    std::uint64_t joined_parts = 0;  ///< after
    std::uint64_t merged_cells = 0;  ///< that went into others
    double distance = 0;             ///< longest way of a merged cell, model units
};

struct SimplifyReport {
    std::string version;
    SimplifyOptions options;  ///< as asked; 0 and empty ones filled in
    InputReport input;
    GridReport grid;
    /// What Topology::Keep has kept: that of the input with vertices of equal positions as one, and
    /// taken apart where it is not manifold.
    std::optional<TopologyReport> kept_topology;
    std::optional<AggregateReport> aggregate;
    LostPlaces dropped;  ///< parts that were too small for SimplifyOptions::drop_parts
    std::uint64_t refined_clusters = 0;  ///< leaves of the cluster tree; 0 without refinement
    FeedbackReport feedback;
    /// Tubes built where a neck of a closed surface was too thin for the clusters.
    std::uint64_t joined_necks = 0;
    std::uint64_t collapses = 0;  ///< of the finishing edge collapse, all LODs
    std::vector<LodReport> lods;
    std::vector<SearchStep> search;  ///< in the order of the tries
    std::vector<StageReport> stages;
    std::vector<std::string> warnings;
    double seconds = 0;
    std::uint64_t bytes_read = 0;
    std::uint64_t bytes_written = 0;
    std::uint64_t temp_bytes_read = 0;
    std::uint64_t temp_bytes_written = 0;
    std::uint64_t peak_temp_bytes = 0;  ///< most temporary disk space at once
    std::uint64_t peak_budget_bytes = 0;
    std::uint64_t peak_resident_bytes = 0;
    /// FNV-1a over the vertices and triangles of all LODs: equal for equal results.
    std::string result_hash;
};

}  // namespace hewer
