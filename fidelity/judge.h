// SPDX-License-Identifier: MIT
/// Whether a level of detail is near enough to its original.
#pragma once

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/report.h"

namespace hewer::fidelity {

/// Samples tell most levels that are too far, and a proof the rest: what no sample hits may be far.
class Judge {
  public:
    /// Of `how`, memory, threads and temporary space are used. The original must outlive it.
    Judge(MeshSource& original, const MeasureOptions& how);

    /// By 100,000 points a side.
    [[nodiscard]] MeasureReport look(MeshSource& level, const Hooks& hooks) const;

    /// Proves that all of both surfaces is within `bound`, or names the places that are not, in
    /// `found`: some hundreds a side, at least `bound` away, worst first. Where a proof is out of
    /// reach the level is measured again, at three times the usual points. True: proven.
    bool prove(MeshSource& level, double bound, MeasureReport& found, const Hooks& hooks) const;

    /// The same for parts (prove_parts_within()), of which `near` is of the original. False only if
    /// a place is named.
    bool prove_parts(const Mesh& near, MeshSource& level, const Mesh& part, double bound,
                     MeasureReport& found, const Hooks& hooks) const;

    [[nodiscard]] MeshSource& original() const { return *original_; }
    [[nodiscard]] const MeasureOptions& options() const { return how_; }

  private:
    MeshSource* original_;
    MeasureOptions how_;
};

/// The larger of both directions.
double largest_distance(const MeasureReport& report);

}  // namespace hewer::fidelity
