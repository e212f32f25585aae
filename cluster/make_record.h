// SPDX-License-Identifier: MIT
/// From the integer sums of a cell to what the refinement works on.
#pragma once

#include <cstdint>
#include <optional>

#include "cluster/cell_record.h"
#include "cluster/cell_sums.h"
#include "cluster/quadric.h"

namespace hewer::cluster {

/// Of a border quadric, before the weight that the user gives: what a border with the default
/// weight is worth against the surface, found by measurement (docs/fit.md).
inline constexpr double kBorderScale = 4;

/// Border edges that do not cancel.
bool has_border(const CellSums& sums);

/// More cells with a border than a surface has: neighbouring triangles disagree about their
/// winding, and the sums that should cancel do not.
bool is_border_implausible(std::uint64_t n_border_cells, std::uint64_t n_cells);

/// The mean is relative to the cell's centre; the id is not set.
CellRecord make_record(const CellSums& sums, const FixedPoint& fixed, double border_weight);

/// The border in a cell with this centre; none where the chords cancel, or leave a line that passes
/// the cell by. The id is not set.
std::optional<BorderLine> border_line(const CellSums& sums, const FixedPoint& fixed,
                                      const CellRecord& record, const Vec3& centre);

CellAttributes make_attributes(const AttributeSums& sums, const FixedPoint& fixed);

/// The mean; 1 where there is no vertex.
float make_weight(const WeightSums& sums);

}  // namespace hewer::cluster
