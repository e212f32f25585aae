// SPDX-License-Identifier: MIT
/// What of the original is near the places of a repair.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fidelity/judge.h"
#include "hewer/mesh_source.h"
#include "hewer/progress.h"
#include "hewer/types.h"

namespace hewer::fidelity {

/// Some of the original's triangles, in memory: all that come within a given reach of some boxes.
/// Memory: kMostBytes at the most, and 72 bytes a triangle more while it is read.
class Neighbourhood {
  public:
    /// Not a matter of the memory that there is: what is repaired depends on it.
    static constexpr std::uint64_t kMostTriangles = 100'000;
    static constexpr std::uint64_t kMostBytes =
        kMostTriangles * (3 * sizeof(Vec3) + sizeof(Triangle));

    Neighbourhood(const Judge& judge, double reach) : judge_(&judge), reach_(reach) {}

    /// Beside what it has been asked for before. A pass over the original, unless that is there.
    /// False, and as before, if it would be too much.
    bool include(std::span<const Bounds> boxes, const Hooks& hooks);
    [[nodiscard]] const Mesh& mesh() const { return mesh_; }

  private:
    [[nodiscard]] bool has(const Bounds& box) const;

    const Judge* judge_;
    double reach_;
    std::vector<Bounds> boxes_;
    Mesh mesh_;
};

}  // namespace hewer::fidelity
