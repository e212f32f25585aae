// SPDX-License-Identifier: MIT
#include "rsimp/cluster_summary.h"

#include <algorithm>
#include <cmath>

namespace hewer::rsimp {

namespace {

// A cell without area still has a place.
constexpr double kLeastWeight = 1e-6;
// Share of the largest eigenvalue that every direction gets: extent counts even where no curvature
// shows.
constexpr double kExtentShare = 0.01;
// What size alone adds to a priority: flat clusters are split too when the budget allows, largest
// first.
constexpr double kExtentCost = 1e-7;

}  // namespace

void ClusterSums::add(const cluster::CellRecord& cell) {
    const Vec3 p{static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
                 static_cast<double>(cell.mean[2])};
    cluster::Quadric q;
    for (std::size_t i = 0; i < 6; ++i) q.a[i] = static_cast<double>(cell.quadric[i]);
    for (std::size_t i = 0; i < 3; ++i) q.b[i] = static_cast<double>(cell.quadric[6 + i]);
    q.c = static_cast<double>(cell.quadric[9]);
    quadric += q.relative_to({-p[0], -p[1], -p[2]});
    const double w = std::max(static_cast<double>(cell.area), kLeastWeight);
    area += static_cast<double>(cell.area);
    weight += w;
    const Vec3 wp = w * p;
    first = first + wp;
    second[0] += wp[0] * p[0];
    second[1] += wp[0] * p[1];
    second[2] += wp[0] * p[2];
    second[3] += wp[1] * p[1];
    second[4] += wp[1] * p[2];
    second[5] += wp[2] * p[2];
    for (std::size_t i = 0; i < 3; ++i) {
        // Cell centres are at integers in the frame, and means well inside their cells.
        const auto center = static_cast<double>(cluster::round_to_int(p[i]));
        low[i] = std::min(low[i], center - 0.5);
        high[i] = std::max(high[i], center + 0.5);
    }
}

ClusterSums& ClusterSums::operator+=(const ClusterSums& other) {
    quadric += other.quadric;
    weight += other.weight;
    first = first + other.first;
    for (std::size_t i = 0; i < second.size(); ++i) second[i] += other.second[i];
    area += other.area;
    face_normal = face_normal + other.face_normal;
    for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], other.low[i]);
        high[i] = std::max(high[i], other.high[i]);
    }
    return *this;
}

double ClusterSums::spread() const {
    return std::max(0.0, second[0] + second[3] + second[5] - dot(first, first) / weight);
}

Vec3 representative(const ClusterSums& sums, const cluster::Eigen3& eigen) {
    Vec3 x = cluster::minimum_from(sums.quadric, eigen, sums.mean());
    for (std::size_t i = 0; i < 3; ++i) x[i] = std::clamp(x[i], sums.low[i], sums.high[i]);
    return x;
}

double farthest_corner(const Vec3& low, const Vec3& high, const Vec3& point) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double d = std::max(point[i] - low[i], high[i] - point[i]);
        sum += d * d;
    }
    return std::sqrt(sum);
}

double priority(const ClusterSums& sums, const Vec3& vertex, Priority kind) {
    switch (kind) {
        case Priority::Quadric:
            return std::max(0.0, sums.quadric.error(vertex)) + kExtentCost * sums.spread();
        case Priority::NormalVariation:
            return std::max(0.0, sums.area - std::sqrt(dot(sums.face_normal, sums.face_normal))) +
                   kExtentCost * sums.spread();
        case Priority::Displacement:
            return farthest_corner(sums.low, sums.high, vertex);
    }
    return 0;
}

double part_priority(const ClusterSums& sums, Priority kind) {
    const Vec3 size = sums.high - sums.low;
    switch (kind) {
        case Priority::Quadric:
            return sums.area * dot(size, size) / 4;
        case Priority::NormalVariation:
            return sums.area;
        case Priority::Displacement:
            return std::numeric_limits<double>::infinity();
    }
    return 0;
}

SplitPlane split_plane(const ClusterSums& sums, const cluster::Eigen3& eigen) {
    const Vec3 mean = sums.mean();
    double best = -1;
    SplitPlane plane;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& e = eigen.vectors[i];
        const double along = dot(e, mean);
        const double extent_sq =
            std::max(0.0, dot(e, sums.second * e) / sums.weight - along * along);
        const double variation =
            std::max(eigen.values[i], 0.0) + kExtentShare * std::max(eigen.values[0], 1e-30);
        const double gain = variation * extent_sq;
        if (gain > best) {
            best = gain;
            plane = {e, along};
        }
    }
    return plane;
}

}  // namespace hewer::rsimp
