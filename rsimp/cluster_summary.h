// SPDX-License-Identifier: MIT
/// What a cluster of cells amounts to: its quadric, its representative vertex, how badly it fits,
/// and where to split it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "cluster/cell_record.h"
#include "cluster/cell_sums.h"
#include "cluster/quadric.h"

namespace hewer::rsimp {

/// What the split priority measures.
enum class Priority {
    Quadric,          ///< integrated squared distance at the representative vertex
    NormalVariation,  ///< area * (1 - |mean normal|), Brodsky & Watson 2000
    Displacement,     ///< farthest that the representative can be from an original vertex
};

/// Sums over the cells of a cluster. Their order is always a function of the cells alone, so
/// floating point does no harm here.
struct ClusterSums {
    cluster::Quadric quadric;  ///< relative to the frame's origin
    double weight = 0;         ///< area, a little more than zero for every cell
    Vec3 first{};              ///< sum of weight * position
    Symmetric3 second{};
    double area = 0;
    Vec3 face_normal{};
    /// Box of the cells' extents, not only of their means.
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              -std::numeric_limits<double>::infinity()};

    /// `cell` with its mean in the frame of its block.
    void add(const cluster::CellRecord& cell);
    /// Other cells, in the same frame.
    ClusterSums& operator+=(const ClusterSums& other);
    /// Weighted sum of the squared distances from the mean.
    [[nodiscard]] double spread() const;
    [[nodiscard]] Vec3 mean() const { return (1 / weight) * first; }
};

/// A plane through a cluster: cells with dot(direction, position) > offset go to the second child.
struct SplitPlane {
    Vec3 direction{};
    double offset = 0;
};

/// The vertex that stands for the cluster: the quadric's minimum as seen from the mean, clamped to
/// the box of the cells.
Vec3 representative(const ClusterSums& sums, const cluster::Eigen3& eigen);

double priority(const ClusterSums& sums, const Vec3& vertex, Priority kind);

/// What it costs that a part of the surface vanishes, at least: all of it moves by its size.
double part_priority(const ClusterSums& sums, Priority kind);

/// Splits across the direction that promises most: among the eigenvectors of A the one with the
/// largest product of normal variation along it and squared extent, through the weighted mean. For
/// a curved patch that is the error each direction contributes to the quadric; a flat patch is
/// halved where it is longest; two sheets in one cluster are separated where they are far apart.
SplitPlane split_plane(const ClusterSums& sums, const cluster::Eigen3& eigen);

/// Distance from `point` to the farthest corner of a box.
double farthest_corner(const Vec3& low, const Vec3& high, const Vec3& point);

}  // namespace hewer::rsimp
