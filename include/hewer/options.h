// SPDX-License-Identifier: MIT
/// What a caller asks of simplify(). Nothing in here that speaks of memory, threads or temporary
/// space changes a bit of the result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"
#include "hewer/types.h"

namespace hewer {

/// How the clusters come about; see docs/pipeline.md.
enum class Method {
    Refine,  ///< fine grid, refined coarse to fine, finished by edge collapse (RSimp on OoCS cells)
    Uniform,  ///< one coarse grid (OoCS), fused, and edge collapse: fastest
    Full,     ///< every original vertex takes part (VMRSimp), with feedback: best and slowest
    Copy,     ///< every triangle as it is: for other formats; docs/output_formats.md
    Auto,     ///< Full for inputs of up to a million vertices, Refine for larger ones; Copy for one
              ///< LOD of the ratio 1, unless options ask for work that Copy does not do
};

/// What makes a cluster the worst one, to be split next.
enum class SplitPriority {
    Quadric,          ///< integrated squared distance to the planes of its triangles
    NormalVariation,  ///< RSimp's own: area share times (1 - |mean normal|)
};

/// What becomes of components, handles and holes.
enum class Topology {
    Simplify,  ///< small ones may go, where the budget needs it; no surface is opened
    Keep,      ///< all of them stay, or the run ends without a result
};

/// One level of detail that is asked for.
struct Target {
    enum class Kind {
        Triangles,      ///< at most `value` triangles
        Vertices,       ///< at most `value` vertices
        Ratio,          ///< at most `value` (0..1] times the triangles of the input
        Error,          ///< no original vertex displaced by more than `value` model units
        RelativeError,  ///< the same, `value` times the diagonal of the bounding box
    };
    Kind kind = Kind::Ratio;
    double value = 0;
};

/// A place that matters more, or less, than the rest.
struct FocusBox {
    Bounds box;
    double weight = 1;          ///< 0 to kMostWeight; boxes that overlap multiply
    bool may_be_empty = false;  ///< no warning if none of the surface is in it
};
/// Largest weight of a FocusBox and of a vertex.
inline constexpr double kMostWeight = 1000;

struct SimplifyOptions {
    /// One per level of detail. Several must be of one kind and go from fine to coarse; all of them
    /// come from one read of the input and nest. Copy needs none, and takes no other than the ratio
    /// 1.
    std::vector<Target> targets;

    Method method = Method::Auto;
    SplitPriority priority = SplitPriority::Quadric;

    /// Keep: every level has the components, the Euler characteristic and the border loops of the
    /// input (report: `kept_topology`), which takes every vertex through the edge collapse: with
    /// Method::Full only. A target below what that needs ends the run with a TopologyLimit.
    Topology topology = Topology::Simplify;

    /// Edge of a grid cell in model units instead of one derived from the target.
    std::optional<double> cell_size;
    /// Box of the input; spares the scan of the vertices for it. A vertex outside is a FormatError.
    std::optional<Bounds> bounds;

    /// Weight of the border quadrics against the surface quadrics. 0: borders may wander.
    double border_weight = 30.0;

    /// What colours and normals of vertices count in the error metric: with W, a difference of a
    /// whole colour channel (of a component of a unit normal by one) counts as much as a distance
    /// of W per cent of the bounding box's diagonal. 0: they are carried along, no more. Not for
    /// the uniform method, nor with SplitPriority::NormalVariation. See docs/attributes.md.
    double color_weight = 0;
    double normal_weight = 0;
    /// See OpenOptions::weight_property. What a source gives as weights (SourceInfo::has_weights)
    /// counts in any case: the surface at a vertex counts as that many times its area. Only ratios
    /// matter, where there is a budget. 0 to kMostWeight, larger ones are taken as that; what is
    /// negative or no number is taken as 1; both are counted (InputDefects::bad_weights).
    std::string weight_property{};
    /// The same by place: the surface in the box counts as that many times its area, to within a
    /// cell of the grid. All weights multiply, and come to a thousandth at least.
    std::vector<FocusBox> focus{};

    /// Rounds, at most, in which the places where the first LOD is far from the input are found,
    /// and the budget is shared out again; 0: none. Unset: two for Full, for Refine one if much is
    /// far, none for Uniform.
    std::optional<unsigned> feedback_rounds;
    /// What is farther than this, in model units, is far. 0: what is several times the common
    /// distance.
    double feedback_distance = 0;
    /// Rounds in which the vertices of each LOD are moved, as a whole, towards the original
    /// surface; 0: none. Unset: what the method calls for (none for Uniform, none under an error
    /// bound).
    std::optional<unsigned> fit_rounds;

    /// Fill in the topology of the input, too: one pass more over its triangles, with 4 bytes a
    /// vertex of memory (8 beyond 2^32 vertices).
    bool topology_report = false;

    /// Connected parts of the model whose box has a diagonal below this are removed before
    /// triangles are spent on them: a length, so of kind Error (model units) or RelativeError
    /// (times the diagonal of the bounding box). To within a cell of the grid; parts nearer to each
    /// other than that are one.
    std::optional<Target> drop_parts;

    /// Connected parts of the model that are nearer to each other than this length (kinds as for
    /// drop_parts) are joined, before triangles are spent on them: so many small parts become fewer
    /// large ones instead of vanishing. Distances are those between cells of the grid. Nothing is
    /// joined unless this is set.
    std::optional<Target> aggregate;

    /// Defects in the input end the run instead of being counted.
    bool strict = false;

    /// Of the input; see OpenOptions::format.
    std::string input_format{};
    /// How simplify_to_files() writes; its own parameter says whether files are replaced.
    MeshFileOptions file{};

    /// Bytes that the whole process may hold. 0: the control group's limit, else half of the
    /// machine.
    std::uint64_t memory_bytes = 0;
    /// 0: as many as the machine has.
    unsigned n_threads = 0;
    /// Where temporary files go. Empty: TMPDIR, else /tmp.
    std::filesystem::path temp_dir;
    /// Most bytes of temporary files. 0: no limit.
    std::uint64_t max_temp_bytes = 0;

    /// Sizes that follow from the memory limit where they are 0. For tests that want data to go to
    /// disk at every turn.
    struct Tuning {
        std::uint64_t page_bytes = 0;       ///< unit of temporary files
        std::uint64_t table_cells = 0;      ///< most cells whose sums are gathered at once
        std::uint64_t window_vertices = 0;  ///< most input vertices that are held at once
        std::uint64_t sort_bytes = 0;       ///< of a sorted run, where records are sorted on disk
        bool spills_at_once = false;        ///< pages go to disk even if memory has room for them
    };
    Tuning tuning;
};

}  // namespace hewer
