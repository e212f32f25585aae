// SPDX-License-Identifier: MIT
/// What a cell amounts to once all of its sums are in, and the triangles between cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hewer::cluster {

/// Slots, later ids, of three different cells, wound as the triangle was.
using CellTriple = std::array<std::uint32_t, 3>;

/// One occupied cell; one cache line. Lengths in cells, areas in cell areas.
struct CellRecord {
    /// xx xy xz yy yz zz of A; b; c: the surface's planes and the weighted borders, relative to
    /// `mean`.
    std::array<float, 10> quadric;
    /// Area-weighted mean of the triangle corners in the cell, at most kMostOffset from the cell's
    /// centre on each axis; relative to that centre, or to the frame of the refiner's block.
    std::array<float, 3> mean;
    float area;        ///< of the surface that the cell stands for
    std::uint32_t id;  ///< own place in Morton order: stays with the record when it is moved
    /// kHasBorder; and below it, for each axis kBeyondBits bits with how far the mean proper is
    /// beyond `mean`, in kBeyondStep, plus half of their range.
    std::uint32_t flags;

    [[nodiscard]] std::array<double, 3> mean_beyond() const {
        std::array<double, 3> result;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t bits = flags >> (kBeyondBits * k) & ((1U << kBeyondBits) - 1);
            result[k] = kBeyondStep * (static_cast<double>(bits) - (1U << (kBeyondBits - 1)));
        }
        return result;
    }
    static constexpr std::uint32_t kHasBorder = 1U << 31;
    static constexpr unsigned kBeyondBits = 10;
    static constexpr double kBeyondStep = 0.05 / 511;
    /// Below one half, so that rounding finds the centre again in single precision.
    static constexpr double kMostOffset = 0.45;
};
static_assert(sizeof(CellRecord) == 64);

/// The border of the surface in a cell, as its chords tell without any connectivity (Lindstrom &
/// Silva 2001).
struct BorderLine {
    std::array<double, 3>
        position;  ///< on the line, next to the cell's mean; cells from the origin
    /// Unit vector; the surface is on the left, seen from its front.
    std::array<float, 3> direction;
    float length;        ///< of the chord, in cells
    std::uint32_t cell;  ///< id
};

/// Attributes of a cell, from the original vertices in it.
struct CellAttributes {
    std::array<float, 3> normal;       ///< sum of the vertex normals, not unit
    std::array<float, 3> face_normal;  ///< area-weighted sum of face normals, cell areas
    std::array<float, 4> color;        ///< sum over n_colors vertices, 0..65535 each
    float n_colors;

    CellAttributes& operator+=(const CellAttributes& other) {
        for (std::size_t i = 0; i < 3; ++i) normal[i] += other.normal[i];
        for (std::size_t i = 0; i < 3; ++i) face_normal[i] += other.face_normal[i];
        for (std::size_t i = 0; i < 4; ++i) color[i] += other.color[i];
        n_colors += other.n_colors;
        return *this;
    }
};

}  // namespace hewer::cluster
