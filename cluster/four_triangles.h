// SPDX-License-Identifier: MIT
/// What triangles add to cells, four of them at once: one in each lane.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "cluster/cell_sums.h"
#include "cluster/lanes.h"
#include "cluster/lattice.h"
#include "cluster/uniform_grid.h"

namespace hewer::cluster {

static_assert(sizeof(PlacedPoint) == sizeof(Words));

/// Corner v of triangle i is [v][i].
using FourCorners = std::array<std::array<PlacedPoint, 4>, 3>;

/// Per triangle: its plane with a third of its area for the cell of each corner; one that is inside
/// a cell brings its whole area with its first corner, and the others bring nothing. Every lane is
/// computed by the same operations, so a triangle's share does not depend on those beside it.
class FourTriangles {
  public:
    HEWER_INLINE FourTriangles(const FourCorners& corners, const UniformGrid& grid,
                               const FixedPoint& fixed)
        : border_unit_(1U << fixed.border_bits) {
        std::array<Words, 3> cells;
        std::array<Lanes3<Reals>, 3> points;
        for (std::size_t v = 0; v < 3; ++v) {
            load(corners[v], grid, fixed, points[v], offsets_[v], wholes_[v], cells[v]);
        }
        const auto inside =
            reinterpret_cast<Words>((cells[0] == cells[1]) & (cells[1] == cells[2]));
        inside_words_ = inside;
        // All ones stay all ones: the widening copies the sign.
        using SignedWords = std::int32_t __attribute__((vector_size(16)));
        is_inside = __builtin_convertvector(reinterpret_cast<SignedWords>(inside), Ints);

        const double step = grid.step_in_cells();
        Lanes3<Reals> edge1;
        Lanes3<Reals> edge2;
        for (std::size_t k = 0; k < 3; ++k) {
            edge1[k] = (points[1][k] - points[0][k]) * step;
            edge2[k] = (points[2][k] - points[0][k]) * step;
        }
        Lanes3<Reals> cross2;
        cross_lanes(edge1, edge2, cross2);
        Reals length;
        square_root(cross2[0] * cross2[0] + cross2[1] * cross2[1] + cross2[2] * cross2[2], length);
        area = 0.5 * length;
        is_flat = ~(length > 0);
        Reals inverse;
        choose(is_flat, Reals{}, 1 / length, inverse);
        for (std::size_t k = 0; k < 3; ++k) normal[k] = cross2[k] * inverse;

        const Reals third = area / 3;
        choose(is_inside, area, third, share);
        weight_ = share * fixed.scale;
        const Lanes3<Reals>& n = normal;
        const Lanes3<Reals> wn = {weight_ * n[0], weight_ * n[1], weight_ * n[2]};
        std::array<Ints, 4> a;
        for (std::size_t k = 0; k < 3; ++k) round_to_ints(wn[0] * n[k], a[k]);
        round_to_ints(wn[1] * n[1], a[3]);
        round_to_ints(wn[1] * n[2], yz_);
        round_to_ints(wn[2] * n[2], zz_);
        transpose(a, a_);
    }

    /// What corner v brings, for each of the triangles; v > 0 only of those that are not inside a
    /// cell.
    HEWER_INLINE void contribute(std::size_t v,
                                 std::array<CellContribution, 4>& contributions) const {
        Lanes3<Reals> at = offsets_[v];
        Lanes3<Words> chord;
        Lanes3<Words> relative;
        Lanes3<Words> border_moment;
        for (std::size_t k = 0; k < 3; ++k) {
            // w - u for the corner v of (u, v, w)
            chord[k] = wholes_[(v + 1) % 3][k] - wholes_[(v + 2) % 3][k];
            relative[k] = (wholes_[v][k] & (border_unit_ - 1)) - border_unit_ / 2;
        }
        cross_lanes(relative, chord, border_moment);
        if (v == 0) {
            // The border vectors of three corners in a cell cancel; their moments come to twice
            // (b - a) x (c - a).
            Lanes3<Words> edge1;
            Lanes3<Words> edge2;
            Lanes3<Words> moment;
            for (std::size_t k = 0; k < 3; ++k) {
                edge1[k] = wholes_[1][k] - wholes_[0][k];
                edge2[k] = wholes_[2][k] - wholes_[0][k];
            }
            cross_lanes(edge1, edge2, moment);
            for (std::size_t k = 0; k < 3; ++k) {
                const Reals mean = (1.0 / 3) * (offsets_[0][k] + offsets_[1][k] + offsets_[2][k]);
                choose(is_inside, mean, at[k], at[k]);
                choose(inside_words_, Words{}, chord[k], chord[k]);
                choose(inside_words_, Words(2 * moment[k]), border_moment[k], border_moment[k]);
            }
        }

        const Reals d = normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2];
        const Reals pull = -weight_ * d;
        std::array<Ints, 4> b_and_c;
        std::array<Ints, 4> moment_and_yz;
        for (std::size_t k = 0; k < 3; ++k) {
            round_to_ints(pull * normal[k], b_and_c[k]);
            round_to_ints(weight_ * at[k], moment_and_yz[k]);
        }
        round_to_ints(pull * -d, b_and_c[3]);
        moment_and_yz[3] = yz_;
        transpose(b_and_c, b_and_c);
        transpose(moment_and_yz, moment_and_yz);
        std::array<Words, 4> chords = {chord[0], chord[1], chord[2], Words{}};
        std::array<Words, 4> moments = {border_moment[0], border_moment[1], border_moment[2],
                                        Words{}};
        transpose(chords, chords);
        transpose(moments, moments);
        for (std::size_t i = 0; i < 4; ++i) {
            contributions[i] = {a_[i], b_and_c[i], moment_and_yz[i], chords[i], moments[i], zz_[i]};
        }
    }

    Lanes3<Reals> normal;  ///< unit; zero for a flat triangle
    Reals area;            ///< of the whole triangle, cell areas
    Reals share;           ///< of the area for each corner that brings something
    Ints is_inside;        ///< a cell: all bits or none; so is_flat
    Ints is_flat;

  private:
    /// Of corner v: where it is in lattice steps, from its cell's centre in cells (truncated to
    /// 2^-52), and in 2^-border_bits cells modulo 2^32, as all arithmetic on borders: differences
    /// of them are right.
    HEWER_INLINE static void load(const std::array<PlacedPoint, 4>& corners,
                                  const UniformGrid& grid, const FixedPoint& fixed,
                                  Lanes3<Reals>& point, Lanes3<Reals>& offset, Lanes3<Words>& whole,
                                  Words& cells) {
        constexpr double kInteger = 4503599627370496.0;  // 2^52: its low bits count units
        std::array<Words, 4> words;
        std::memcpy(&words, &corners, sizeof words);
        transpose(words, words);
        cells = words[3];
        const unsigned fraction_bits = grid.fraction_bits();
        for (std::size_t k = 0; k < 3; ++k) {
            const Longs wide = __builtin_convertvector(words[k], Longs);
            point[k] =
                reinterpret_cast<Reals>(wide | std::bit_cast<std::uint64_t>(kInteger)) - kInteger;
            const Longs place = wide * grid.multiplier();
            const Longs fraction = (place << (64 - fraction_bits)) >> 12;
            offset[k] = reinterpret_cast<Reals>(fraction | std::bit_cast<std::uint64_t>(1.0)) - 1.5;
            whole[k] = __builtin_convertvector(place >> (fraction_bits - fixed.border_bits), Words);
        }
    }

    std::uint32_t border_unit_;
    std::array<Lanes3<Reals>, 3> offsets_;
    std::array<Lanes3<Words>, 3> wholes_;
    Words inside_words_;
    Reals weight_;
    std::array<Ints, 4> a_;  // by triangle: xx xy xz yy
    Ints yz_;
    Ints zz_;
};

}  // namespace hewer::cluster
