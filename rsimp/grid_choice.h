// SPDX-License-Identifier: MIT
/// From what is asked for to the grid that serves it. Nothing in here knows of memory or threads.
#pragma once

#include <cstdint>

#include "cluster/cell_sample.h"
#include "cluster/lattice.h"
#include "hewer/mesh_source.h"
#include "hewer/options.h"

namespace hewer::rsimp {

/// Cells per vertex of the finest LOD. More cells see more of the surface and cost time;
/// docs/quality.md has the measurements.
inline constexpr double kCellsPerVertex = 7;
/// The same for the uniform method, which fuses them.
inline constexpr double kUniformCellsPerVertex = 2;
/// Inputs with up to so many vertices are refined from the vertices themselves, unless told
/// otherwise: that takes a second or two.
inline constexpr std::uint64_t kVerticesWorthAll = 1'000'000;
/// Targets, however small, get at least this many cells: less would save no time worth having, and
/// parts that share a cell with others could not be told when they are lost.
inline constexpr double kFewestCells = 50'000;
inline constexpr double kUniformFewestCells = 30'000;
/// But for the uniform method, inputs get at least one cell for so many of their triangles, up to
/// kMostOfFewest: the cells take little of the time that reading so many takes.
inline constexpr double kTrianglesPerCell = 16;
inline constexpr double kMostOfFewest = 400'000;
/// Clusters per vertex of the finest LOD at which refinement, or fusion, hands over to the edge
/// collapse. Two instead of three save a seventh of the time and cost 2 to 3 % of error; fusion
/// with one and a half has .5 to .9 of the error that it has with one and no collapse.
constexpr double clusters_per_vertex(Method method) {
    if (method == Method::Uniform) return 1.5;
    return method == Method::Refine ? 2 : 3;
}
/// Whether so many clusters are too many to be worth finding: the collapse begins with the cells
/// themselves then.
constexpr bool are_cells_enough(Method method, double clusters, std::uint64_t n_cells) {
    return clusters * (method == Method::Uniform ? 1 : 1.3) >= static_cast<double>(n_cells);
}
/// Rounds of feedback, unless told otherwise.
inline constexpr unsigned kFeedbackRounds = 2;
/// Rounds of the fit, unless told otherwise: with Method::Refine the second gains 2 to 3 % and
/// costs a tenth of the time (docs/fit.md).
constexpr unsigned default_fit_rounds(Method method) {
    if (method == Method::Uniform || method == Method::Copy) return 0;
    return method == Method::Refine ? 1 : 4;
}
/// Whether the fit of a finest LOD of so many vertices looks at the triangles between cells instead
/// of the cells. Where cells are vertices these triangles are the input's own, and seen twice as
/// often as vertices, which helps for longer; else they cut the corners of what the cells average.
constexpr bool has_few_cells(Method method, std::uint64_t n_cells, double vertices) {
    return static_cast<double>(n_cells) < (method == Method::Full ? 18 : 6) * vertices;
}
/// With an error bound E the cells are at most E / kCellsPerError long.
inline constexpr double kCellsPerError = 8;
/// With a distance to keep (SimplifyOptions::feedback_distance) those of Method::Full are at most
/// so many parts of it long, but for this factor on the usual resolution: collapses are clamped to
/// cells, and need some room.
inline constexpr double kCellsPerDistance = 2;
inline constexpr double kMostSeparation = 4;

/// Of the diagonal, that a difference of attributes by one counts as with a weight of one.
inline constexpr double kAttributeUnit = 0.01;

/// Vertices that a target comes to, from the number of faces in the input. For Error targets: 0.
double target_vertices(const Target& target, std::uint64_t n_input_faces);

/// Cells that a finest LOD of so many vertices gets, for the methods Refine and Uniform.
double wanted_cells(Method method, double vertices, std::uint64_t n_input_faces);

/// Error bound of a target in model units; 0 for budgets.
double target_error(const Target& target, const Bounds& bounds);

/// Cells along the longest side of the box, for the methods Refine and Full and for a given cell
/// size; `finer` times the usual number of cells for Refine. Throws InvalidArgument if the cell
/// size or the error bound is too small for 2^20 cells.
double choose_resolution(const SimplifyOptions& options, const Bounds& bounds,
                         const cluster::CellSample& sample, std::uint64_t n_input_faces,
                         double finer);

/// What Method::Auto stands for; any other method as it is.
Method method_for(const SimplifyOptions& options, const SourceInfo& info);

/// Rounds of feedback at most: unless told otherwise two for Full, one for Refine, none for
/// Uniform.
unsigned feedback_rounds(const SimplifyOptions& options);
/// Nobody has asked for the round: it is made only where much is far.
bool looks_before_feedback(const SimplifyOptions& options);

/// Rounds of the fit. None for the uniform method, whose point is speed, nor under an error bound,
/// which only the clusters' own places are known to keep; unless they are asked for.
unsigned fit_rounds(const SimplifyOptions& options);

/// Refuses what contradicts itself or leaves its range: InvalidArgument.
void check_options(const SimplifyOptions& options);

}  // namespace hewer::rsimp
