// SPDX-License-Identifier: MIT
#include "rsimp/nearest_faces.h"

#include <algorithm>
#include <array>

namespace hewer::rsimp {

namespace {

// Points that one thread looks for the faces of.
constexpr std::size_t kPointsPerSearch = 256;

std::vector<Point3f> to_single(std::span<const Vec3> points) {
    std::vector<Point3f> result(points.size());
    std::transform(points.begin(), points.end(), result.begin(),
                   [](const Vec3& p) { return rsimp::to_single(p); });
    return result;
}

}  // namespace

NearestFaces::NearestFaces(ooc::Workers& workers, const MeshPiece& piece)
    : workers_(workers),
      tree_(to_single(piece.positions), piece.faces),
      is_empty_(piece.faces.empty()) {}

std::span<const FaceTree::Hit> NearestFaces::find(std::span<const WeightedPoint> points,
                                                  double most_distance) {
    hits_.assign(points.size(), {0, 0, FaceTree::kNone});
    if (is_empty_) return hits_;
    const auto most = static_cast<float>(most_distance * most_distance);
    workers_.for_ranges(points.size(), kPointsPerSearch, [&](std::size_t begin, std::size_t end) {
        std::array<Point3f, kPointsPerSearch> places;
        for (std::size_t i = begin; i < end; ++i) places[i - begin] = points[i].position;
        std::uint32_t guess = guess_;
        tree_.nearest(std::span(places).first(end - begin), most, guess,
                      std::span(hits_).subspan(begin, end - begin));
    });
    for (const FaceTree::Hit& hit : hits_) {
        if (hit.face != FaceTree::kNone) guess_ = hit.slot;
    }
    return hits_;
}

}  // namespace hewer::rsimp
