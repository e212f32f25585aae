// SPDX-License-Identifier: MIT
/// Whether two surfaces are within a distance of each other, proven and not sampled.
#pragma once

#include <cstdint>
#include <vector>

#include "hewer/measure.h"
#include "hewer/mesh_source.h"
#include "hewer/progress.h"

namespace hewer {

struct WithinReport {
    enum class Verdict {
        /// No point of either surface is farther from the other one.
        Proven,
        /// Some point is, or is nearer by less than a hundredth: `forward` and `backward` tell.
        Refuted,
        /// Neither has been shown with as many pieces as are tried: 32 for each triangle.
        Undecided,
    };
    Verdict verdict = Verdict::Undecided;
    /// Refuted: the worst places found, worst first, MeasureOptions::most_places a direction, no
    /// two within MeasureOptions::places_apart; of the original and of the simplified surface.
    /// Their distances are least ones.
    std::vector<WorstPlace> forward;
    std::vector<WorstPlace> backward;
    std::uint64_t n_pieces = 0;  ///< looked at, of both surfaces

    /// Of the worst place; 0 if there is none.
    [[nodiscard]] double farthest() const;
};

/// Both directions, all points of all triangles: not only vertices and samples. The distance to one
/// triangle is convex, so over a piece of surface it is greatest at a corner: where all corners of
/// a piece are within `distance` of one triangle of the other surface, all of the piece is (Tang,
/// Lee & Kim 2009). From a piece for which no such triangle is found the part that one covers is
/// cut off, until nothing is left, or what is left is far for sure. Theirs halves pieces and holds
/// both surfaces in memory.
///
/// Passes over the original: two, and one for each round of pieces of the simplified surface, ten
/// to twenty for most, or more where memory does not suffice for all of them. Memory: 43 bytes a
/// triangle of the simplified surface, 124 for each piece of a batch, which is as large as the
/// limit allows, and a window over the original's vertices. Disk: 36 bytes a piece, where memory is
/// short. The same verdict, places and number of pieces for any threads and memory limit. Of
/// `options`, places, memory, threads and temporary space are used. Throws: as measure();
/// InvalidArgument if `distance` is not above 0.
WithinReport prove_within(MeshSource& original, MeshSource& simplified, double distance,
                          const MeasureOptions& options = {}, const Hooks& hooks = {});

/// The same for a part of the original and one of the simplified surface: whether all of
/// `original_part` is within `distance` of `simplified`, and all of `simplified_part` of
/// `original_part`. So if that has what of the original is within `distance` of `simplified_part`,
/// what is said of this part is right.
///
/// Memory: 43 bytes a triangle of the first two and 36 of the third. Else as prove_within().
WithinReport prove_parts_within(MeshSource& original_part, MeshSource& simplified,
                                MeshSource& simplified_part, double distance,
                                const MeasureOptions& options = {}, const Hooks& hooks = {});

WithinReport prove_within_files(const InputPaths& original, const InputPaths& simplified,
                                double distance, const MeasureOptions& options = {},
                                const Hooks& hooks = {});

}  // namespace hewer
