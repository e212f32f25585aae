// SPDX-License-Identifier: MIT
#include "rsimp/border_moves.h"

#include <algorithm>
#include <cmath>

#include "rsimp/damped_solve.h"
#include "rsimp/half_edges.h"

namespace hewer::rsimp {

namespace {

// As in the fit of the surface.
constexpr double kDamping = .005;
constexpr double kOverRelaxation = 1.5;
// A vertex that fewer points pull stays: its edges are hardly longer than the original's, and the
// points, which are vertices of these, say nothing about the curve between them.
constexpr std::uint32_t kLeastPoints = 8;

/// The edges of a piece with one face, as the face runs, none of shreds; marks the own vertices at
/// edges that have not got two faces.
std::vector<LocalFace> border_edges(const MeshPiece& piece, std::vector<bool>& is_fixed) {
    std::vector<LocalFace> edges;
    for_each_edge(piece.faces, piece.positions.size(),
                  [&](std::uint32_t low, std::span<const HalfEdge> group) {
                      if (group.size() == 2) return;
                      const std::uint32_t high = group[0].other;
                      if (low < piece.n_own) is_fixed[low] = true;
                      if (high < piece.n_own) is_fixed[high] = true;
                      if (group.size() > 2) return;
                      const LocalFace& face = piece.faces[group[0].id / 3];
                      const std::uint32_t to = face[(group[0].id % 3 + 1) % 3];
                      edges.push_back({face[group[0].id % 3], to, to});
                  });
    if (edges.size() > piece.faces.size()) edges.clear();
    return edges;
}

std::vector<Point3f> to_single(const std::vector<Vec3>& points) {
    std::vector<Point3f> result(points.size());
    std::transform(points.begin(), points.end(), result.begin(),
                   [](const Vec3& p) { return rsimp::to_single(p); });
    return result;
}

}  // namespace

BorderMoves::BorderMoves(const MeshPiece& piece, double most_distance)
    : piece_(piece),
      most_(static_cast<float>(most_distance * most_distance)),
      is_fixed_(piece.n_own),
      edges_(border_edges(piece, is_fixed_)),
      tree_(edges_.empty() ? std::vector<Point3f>() : to_single(piece.positions), edges_),
      has_border_(std::find(is_fixed_.begin(), is_fixed_.end(), true) != is_fixed_.end()),
      pulls_(has_border_ ? piece.n_own : 0) {}

void BorderMoves::pull(std::span<const WeightedPoint> points) {
    if (edges_.empty()) return;
    places_.clear();
    for (const WeightedPoint& point : points) places_.push_back(point.position);
    hits_.resize(places_.size());
    tree_.nearest(places_, most_, guess_, hits_);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (hits_[i].face == FaceTree::kNone) continue;
        const LocalFace& edge = edges_[hits_[i].face];
        if (edge[0] >= piece_.n_own && edge[1] >= piece_.n_own) continue;
        const WeightedPoint& point = points[i];
        const Vec3 p{point.position[0], point.position[1], point.position[2]};
        const Vec3 direction{point.normal[0], point.normal[1], point.normal[2]};
        const Vec3& from = piece_.positions[edge[0]];
        const Vec3 along = piece_.positions[edge[1]] - from;
        const double length_sq = dot(along, along);
        if (!(dot(along, direction) > 0)) continue;
        const double t = std::clamp(dot(p - from, along) / length_sq, 0.0, 1.0);
        const Vec3 residual = p - (from + t * along);
        // Beyond an end it pulls along the edge, too.
        const double across = t > 0 && t < 1 ? 1 / length_sq : 0;
        const double length = std::sqrt(dot(residual, residual));
        for (const bool is_end : {false, true}) {
            const std::uint32_t v = edge[is_end ? 1 : 0];
            if (v >= piece_.n_own) continue;
            const double w = (is_end ? t : 1 - t) * static_cast<double>(point.weight);
            Pull& pull = pulls_[v];
            pull.matrix[0] += w * (1 - across * along[0] * along[0]);
            pull.matrix[1] -= w * across * along[0] * along[1];
            pull.matrix[2] -= w * across * along[0] * along[2];
            pull.matrix[3] += w * (1 - across * along[1] * along[1]);
            pull.matrix[4] -= w * across * along[1] * along[2];
            pull.matrix[5] += w * (1 - across * along[2] * along[2]);
            pull.residual = pull.residual + w * residual;
            ++pull.n_points;
            pull.longest = std::max(pull.longest, length);
        }
    }
}

void BorderMoves::replace(std::span<Vec3> moves) const {
    for (std::uint32_t v = 0; v < piece_.n_own; ++v) {
        if (!is_fixed_[v]) continue;
        const Pull& pull = pulls_[v];
        moves[v] = {};
        if (pull.n_points < kLeastPoints) continue;
        const Vec3 move = kOverRelaxation * damped_solve(pull.matrix, pull.residual, kDamping);
        const double length = std::sqrt(dot(move, move));
        moves[v] = length > pull.longest ? (pull.longest / length) * move : move;
    }
}

}  // namespace hewer::rsimp
