// SPDX-License-Identifier: MIT
/// Faces of any size to triangles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hewer/types.h"

namespace hewer::streaming {

/// What the faces of one block held. Rows count from the block's first; meaningful if n_... > 0.
struct FaceFindings {
    std::uint64_t n_polygons = 0;
    std::uint64_t n_short = 0;
    std::uint64_t first_short_row = 0;
    std::uint64_t n_out_of_range = 0;
    std::uint64_t first_out_of_range_row = 0;
};

/// Writes the fans of consecutive faces into storage that is sized beforehand.
class FanWriter {
  public:
    /// `out` has room for the fans of all faces to come.
    FanWriter(Triangle* out, std::uint64_t n_vertices) : out_(out), n_vertices_(n_vertices) {}

    /// Adds face `row` of `n_corners`; next_corner() yields their ids one by one. Triangles with an
    /// id that is no vertex are left out and counted. (Negative ids come as values near 2^64.)
    template <typename NextCorner>
    void add(std::uint64_t row, std::uint64_t n_corners, const NextCorner& next_corner) {
        if (n_corners < 3) {
            if (findings_.n_short++ == 0) findings_.first_short_row = row;
            for (std::uint64_t i = 0; i < n_corners; ++i) (void)next_corner();
            return;
        }
        findings_.n_polygons += n_corners > 3 ? 1 : 0;
        const std::uint64_t a = next_corner();
        std::uint64_t b = next_corner();
        for (std::uint64_t i = 2; i < n_corners; ++i) {
            const std::uint64_t c = next_corner();
            if (std::max({a, b, c}) < n_vertices_) {
                *out_++ = {a, b, c};
            } else if (findings_.n_out_of_range++ == 0) {
                findings_.first_out_of_range_row = row;
            }
            b = c;
        }
    }

    [[nodiscard]] const Triangle* end() const { return out_; }
    [[nodiscard]] const FaceFindings& findings() const { return findings_; }

  private:
    Triangle* out_;
    std::uint64_t n_vertices_;
    FaceFindings findings_;
};

}  // namespace hewer::streaming
