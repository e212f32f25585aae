// SPDX-License-Identifier: MIT
#include "streaming/ordered_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "streaming/dereference.h"
#include "streaming/equal_corners.h"

namespace hewer::streaming {

namespace {

constexpr std::uint64_t kResidentShare = 4;

/// As the file has them.
template <typename Real>
struct PlainEncoder {
    using Point = std::array<Real, 3>;
    [[nodiscard]] static Point encode(const Vec3& p) {
        return {static_cast<Real>(p[0]), static_cast<Real>(p[1]), static_cast<Real>(p[2])};
    }
    [[nodiscard]] static bool is_absent(const Point& p) {
        return !std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]);
    }
};

template <typename Real>
void stream_as(ooc::Context& context, MeshSource& source, std::uint64_t most_resident,
               const TakePoints& take) {
    using Encoder = PlainEncoder<Real>;
    const std::uint64_t bytes = most_resident != 0 ? most_resident * sizeof(typename Encoder::Point)
                                                   : context.budget().limit() / kResidentShare;
    Dereference<Encoder> triangles(context, source, Encoder(), bytes);
    std::vector<std::array<Vec3, 3>> piece;
    triangles.for_batches_in_order(
        [&](unsigned, const auto& corners, std::span<const Triangle> ids) {
            piece.clear();
            for (std::size_t i = 0; i < ids.size(); ++i) {
                if (is_degenerate(ids[i])) continue;
                std::array<Vec3, 3>& t = piece.emplace_back();
                for (std::size_t c = 0; c < 3; ++c) {
                    std::copy(corners[i][c].begin(), corners[i][c].end(), t[c].begin());
                }
            }
            take(piece);
        });
}

}  // namespace

void stream_points(ooc::Context& context, MeshSource& source, std::uint64_t most_resident,
                   const TakePoints& take) {
    if (source.info().has_double_positions) {
        stream_as<double>(context, source, most_resident, take);
    } else {
        stream_as<float>(context, source, most_resident, take);
    }
}

}  // namespace hewer::streaming
