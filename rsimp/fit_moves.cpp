// SPDX-License-Identifier: MIT
#include "rsimp/fit_moves.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ooc/triangle_foot.h"
#include "rsimp/damped_solve.h"
#include "rsimp/shows_back.h"

namespace hewer::rsimp {

namespace {

// Of the trace of a vertex' matrix: what directions without any residual get, so that the vertex
// does not slide along the surface.
constexpr double kDamping = .005;
// A majorised step is too short where neighbours agree; this much longer it still descends.
constexpr double kOverRelaxation = 1.5;
// Of the trace of a vertex' matrix: what the point nearest to the vertex itself gets. Points are
// the dearer the fewer they are: a tenth costs 3 % of RMS where there are five to a vertex.
constexpr double kVertexShare = .06;
// Cosines of how far a face may turn in a round, and in all of them.
constexpr double kMostTurn = 0.5;
constexpr double kMostTurnOfAll = 0.17;
// 15 degrees more are still allowed after this.
constexpr double kHardlyTurned = 0.45;
constexpr double kTiny = 1e-12;

Vec3 unit(const Vec3& v) {
    const double length = std::sqrt(dot(v, v));
    return length > kTiny ? (1 / length) * v : Vec3{};
}

Vec3 normal_of(const std::array<Vec3, 3>& p) {
    return unit(cross(p[1] - p[0], p[2] - p[0]));
}

/// The face does not turn far, whichever of its corners move.
bool is_safe(const MeshPiece& piece, const LocalFace& face, std::span<const Vec3> at_first,
             std::span<const Vec3> moves) {
    std::array<Vec3, 3> now;
    for (std::size_t k = 0; k < 3; ++k) now[k] = piece.positions[face[k]];
    const Vec3 first = normal_of({at_first[face[0]], at_first[face[1]], at_first[face[2]]});
    const Vec3 crossed = cross(now[1] - now[0], now[2] - now[0]);
    const double doubled_area = std::sqrt(dot(crossed, crossed));
    const Vec3 before = doubled_area > kTiny ? (1 / doubled_area) * crossed : Vec3{};
    // Most moves are short: corners that move by less than a tenth of the least height turn the
    // face by less than 15 degrees, whichever of them do.
    double longest_edge = 0;
    double longest_move = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = now[(k + 1) % 3] - now[k];
        longest_edge = std::max(longest_edge, dot(edge, edge));
        longest_move = std::max(longest_move, dot(moves[face[k]], moves[face[k]]));
    }
    if (100 * longest_move * longest_edge < doubled_area * doubled_area &&
        dot(before, first) > kHardlyTurned) {
        return true;
    }
    for (unsigned moved = 1; moved < 8; ++moved) {
        std::array<Vec3, 3> p = now;
        for (std::size_t k = 0; k < 3; ++k) {
            if ((moved >> k & 1U) != 0) p[k] = p[k] + moves[face[k]];
        }
        const Vec3 normal = normal_of(p);
        if (dot(before, normal) < kMostTurn || dot(first, normal) < kMostTurnOfAll) return false;
    }
    return true;
}

}  // namespace

void FitMoves::Pull::add(const Vec3& n, double d, double weight) {
    matrix[0] += weight * n[0] * n[0];
    matrix[1] += weight * n[0] * n[1];
    matrix[2] += weight * n[0] * n[2];
    matrix[3] += weight * n[1] * n[1];
    matrix[4] += weight * n[1] * n[2];
    matrix[5] += weight * n[2] * n[2];
    residual = residual + (weight * d) * n;
}

FitMoves::FitMoves(const MeshPiece& piece, double most_distance)
    : piece_(piece),
      most_(static_cast<float>(most_distance * most_distance)),
      pulls_(piece.n_own) {}

void FitMoves::pull(const WeightedPoint& point, std::uint32_t nearest_face, float squared) {
    const std::uint32_t n_own = piece_.n_own;
    const LocalFace& face = piece_.faces[nearest_face];
    if (squared > most_ || (face[0] >= n_own && face[1] >= n_own && face[2] >= n_own)) return;
    distances_.add(squared, point.weight);
    const Vec3 p = as_vec3(point.position);
    const Vec3& a = piece_.positions[face[0]];
    const Vec3& b = piece_.positions[face[1]];
    const Vec3& c = piece_.positions[face[2]];
    const TriangleFoot foot = foot_of(p, a, b, c);
    const Vec3 residual = p - (foot.weights[0] * a + foot.weights[1] * b + foot.weights[2] * c);
    const double length = std::sqrt(dot(residual, residual));
    Vec3 n = unit(cross(b - a, c - a));
    const Vec3 front = as_vec3(point.normal);
    if (shows_back(n, front)) return;
    if (!foot.is_inside && length > kTiny) n = (1 / length) * residual;
    const double d = dot(residual, n);
    for (std::size_t k = 0; k < 3; ++k) {
        if (face[k] >= n_own) continue;
        const double w = foot.weights[k] * static_cast<double>(point.weight);
        Pull& pull = pulls_[face[k]];
        pull.add(n, d, w);
        pull.longest = std::max(pull.longest, std::abs(d));
        const Vec3 to_point = p - piece_.positions[face[k]];
        const double squared_way = dot(to_point, to_point);
        if (squared_way < pull.nearest) {
            pull.nearest = squared_way;
            pull.to_nearest = to_point;
            pull.front = front;
        }
    }
}

std::vector<Vec3> FitMoves::moves() const {
    std::vector<Vec3> moves;
    moves.reserve(pulls_.size());
    for (Pull pull : pulls_) {
        if (std::isfinite(pull.nearest)) {
            pull.add(pull.front, dot(pull.to_nearest, pull.front),
                     kVertexShare * (pull.matrix[0] + pull.matrix[3] + pull.matrix[5]));
        }
        const Vec3 move = kOverRelaxation * damped_solve(pull.matrix, pull.residual, kDamping);
        const double length = std::sqrt(dot(move, move));
        moves.push_back(length > pull.longest ? (pull.longest / length) * move : move);
    }
    return moves;
}

std::vector<bool> held_vertices(const MeshPiece& piece, std::span<const Vec3> at_first,
                                std::span<const Vec3> moves) {
    std::vector<bool> is_held(piece.n_own);
    for (const LocalFace& face : piece.faces) {
        if (face[0] >= piece.n_own && face[1] >= piece.n_own && face[2] >= piece.n_own) continue;
        if (is_safe(piece, face, at_first, moves)) continue;
        for (const std::uint32_t v : face) {
            if (v < piece.n_own) is_held[v] = true;
        }
    }
    return is_held;
}

}  // namespace hewer::rsimp
