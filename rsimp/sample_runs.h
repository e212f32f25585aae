// SPDX-License-Identifier: MIT
/// The samples of a surface of any size, to be read place by place.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "ooc/context.h"
#include "rsimp/fit_samples.h"
#include "rsimp/mesh_piece.h"
#include "rsimp/run_boxes.h"

namespace hewer::rsimp {

/// A point of the original surface, and how much of it the point stands for.
struct WeightedPoint {
    Point3f position;
    float weight;
    Point3f normal;  ///< about a unit long
};

/// The samples stay where they are, in Morton order: they are known in small runs with the box of
/// each, and whoever asks for a place reads the runs that are near it. One pass over the samples to
/// begin with. Memory: 24 bytes for each 1024 samples.
class SampleRuns {
  public:
    /// Positions are told relative to `origin`. Of more than some 24 samples for each of
    /// `n_vertices` only every so many count: more cost time and change next to nothing.
    SampleRuns(ooc::Context& context, const ooc::Spool<FitSample>& samples, const Vec3& origin,
               std::uint64_t n_vertices);

    /// So many are worth being shared out among threads.
    static constexpr std::uint64_t kMostPoints = 1 << 12;

    /// Samples that count.
    [[nodiscard]] std::uint64_t size() const { return (samples_.size() + stride_ - 1) / stride_; }

    /// Root of the area for each vertex, in cells: about their mean distance.
    [[nodiscard]] double spacing() const { return spacing_; }

    /// Calls visit(points), with up to kMostPoints of them, for the samples within `reach` of
    /// `box`, or for one of `share` of them, relative to `centre`, in the order of the samples. Any
    /// thread.
    void for_each(const FloatBox& box, double reach, const Vec3& centre,
                  const std::function<void(std::span<const WeightedPoint>)>& visit,
                  std::uint64_t share = 1) const;

    /// No more points than this are visited then.
    [[nodiscard]] std::uint64_t points_at_most(const FloatBox& box, double reach) const;

  private:
    const ooc::Spool<FitSample>& samples_;
    Vec3 origin_;
    RunBoxes boxes_;
    std::uint64_t stride_ = 1;  // one of so many samples counts
    double spacing_ = 0;
};

}  // namespace hewer::rsimp
