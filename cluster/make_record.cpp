// SPDX-License-Identifier: MIT
#include "cluster/make_record.h"

#include <algorithm>
#include <cmath>

namespace hewer::cluster {

namespace {

// More border cells than this share: neighbouring triangles disagree about their winding, and the
// sums that should cancel do not.
constexpr double kMostBorderCells = 0.5;
constexpr std::uint64_t kLeastCellsToJudge = 1000;
constexpr double kVertexNormalScale = 1 << 20;

// A border line that is farther than this from the centre of its cell, on any axis, is what
// rounding or dirt has left.
constexpr double kMostFromCentre = 1;

/// A line with a length: chord E, and moment M = p X E for any p on it.
struct Chord {
    Vec3 e;
    Vec3 m;
};

Chord border_chord(const CellSums& sums, const FixedPoint& fixed) {
    // Every border edge was seen from both of its ends: half of the sum is the chord.
    const double unit = std::ldexp(0.5, -static_cast<int>(fixed.border_bits));
    const auto value = [&](std::size_t i) {
        return static_cast<double>(static_cast<std::int32_t>(sums.border[i]));
    };
    const Vec3 e{value(0) * unit, value(1) * unit, value(2) * unit};
    const double unit_moment = unit * std::ldexp(1.0, -static_cast<int>(fixed.border_bits));
    return {e, {value(3) * unit_moment, value(4) * unit_moment, value(5) * unit_moment}};
}

/// The squared distance to the border line through the cell, weighted with the squared length of
/// its chord: |x X E - M|^2.
Quadric border_quadric(const CellSums& sums, const FixedPoint& fixed) {
    const auto [e, m] = border_chord(sums, fixed);
    const double ee = dot(e, e);
    Quadric q;
    if (!(ee > 0)) return q;  // a hole inside one cell: nothing to hold on to
    q.a = {ee - e[0] * e[0], -e[0] * e[1], -e[0] * e[2],
           ee - e[1] * e[1], -e[1] * e[2], ee - e[2] * e[2]};
    q.b = -1.0 * cross(e, m);
    q.c = dot(m, m);
    return q;
}

}  // namespace

bool has_border(const CellSums& sums) {
    return std::any_of(sums.border.begin(), sums.border.end(),
                       [](std::uint32_t x) { return x != 0; });
}

bool is_border_implausible(std::uint64_t n_border_cells, std::uint64_t n_cells) {
    return n_cells >= kLeastCellsToJudge &&
           static_cast<double>(n_border_cells) > kMostBorderCells * static_cast<double>(n_cells);
}

CellRecord make_record(const CellSums& sums, const FixedPoint& fixed, double border_weight) {
    const double unit = 1 / fixed.scale;
    const auto value = [&](std::size_t i) { return static_cast<double>(sums.surface[i]) * unit; };
    Quadric q;
    for (std::size_t i = 0; i < 6; ++i) q.a[i] = value(i);
    for (std::size_t i = 0; i < 3; ++i) q.b[i] = value(6 + i);
    q.c = value(9);
    const double area = q.trace();
    CellRecord record{};
    Vec3 mean{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double exact = area > 0 ? std::clamp(value(10 + i) / area, -0.5, 0.5) : 0;
        mean[i] = std::clamp(exact, -CellRecord::kMostOffset, CellRecord::kMostOffset);
        const auto beyond = static_cast<std::int32_t>(
            round_to_int((exact - mean[i]) * (1 / CellRecord::kBeyondStep)));
        record.flags |= static_cast<std::uint32_t>(beyond + (1 << (CellRecord::kBeyondBits - 1)))
                        << (CellRecord::kBeyondBits * i);
    }
    const bool is_border = has_border(sums);
    if (is_border) record.flags |= CellRecord::kHasBorder;
    if (is_border && border_weight > 0) {
        const Quadric border = border_quadric(sums, fixed);
        border_weight *= kBorderScale;
        for (std::size_t i = 0; i < 6; ++i) q.a[i] += border_weight * border.a[i];
        for (std::size_t i = 0; i < 3; ++i) q.b[i] += border_weight * border.b[i];
        q.c += border_weight * border.c;
    }
    q = q.relative_to(mean);
    for (std::size_t i = 0; i < 6; ++i) record.quadric[i] = static_cast<float>(q.a[i]);
    for (std::size_t i = 0; i < 3; ++i) record.quadric[6 + i] = static_cast<float>(q.b[i]);
    record.quadric[9] = static_cast<float>(std::max(0.0, q.c));
    for (std::size_t i = 0; i < 3; ++i) record.mean[i] = static_cast<float>(mean[i]);
    record.area = static_cast<float>(area);
    return record;
}

std::optional<BorderLine> border_line(const CellSums& sums, const FixedPoint& fixed,
                                      const CellRecord& record, const Vec3& centre) {
    if (!has_border(sums)) return {};
    const auto [e, m] = border_chord(sums, fixed);
    const double ee = dot(e, e);
    if (!(ee > 0)) return {};
    Vec3 mean = record.mean_beyond();
    for (std::size_t k = 0; k < 3; ++k) mean[k] += static_cast<double>(record.mean[k]);
    const Vec3 place = (1 / ee) * (cross(e, m) + dot(e, mean) * e);
    BorderLine line{};
    const double length = std::sqrt(ee);
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(std::abs(place[k]) <= kMostFromCentre)) return {};
        line.position[k] = centre[k] + place[k];
        line.direction[k] = static_cast<float>(e[k] / length);
    }
    line.length = static_cast<float>(length);
    return line;
}

CellAttributes make_attributes(const AttributeSums& sums, const FixedPoint& fixed) {
    CellAttributes a{};
    for (std::size_t i = 0; i < 3; ++i) {
        a.normal[i] = static_cast<float>(static_cast<double>(sums.normal[i]) / kVertexNormalScale);
        a.face_normal[i] =
            static_cast<float>(static_cast<double>(sums.face_normal[i]) / fixed.scale);
    }
    for (std::size_t i = 0; i < 4; ++i) a.color[i] = static_cast<float>(sums.color[i]);
    a.n_colors = static_cast<float>(sums.n_colors);
    return a;
}

float make_weight(const WeightSums& sums) {
    if (sums.n_vertices == 0) return 1;
    return static_cast<float>(static_cast<double>(sums.sum) /
                              (kWeightScale * static_cast<double>(sums.n_vertices)));
}

}  // namespace hewer::cluster
