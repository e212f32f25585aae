// SPDX-License-Identifier: MIT
/// What it costs that a small component vanishes.
#pragma once

#include <cstdint>
#include <span>

#include "rsimp/block_mesh.h"
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// So many times what it adds to the error is what a part is worth, as none is to go without need:
/// what the collapse does to the rest is made good in part by the fit, what is gone is gone
/// (docs/topology.md has figures).
inline constexpr double kWorthKeeping = 4;

/// What the squared distances from the original to the result grow by, in the unit of quadrics:
/// the area of the component, whose vertices and faces are given by their places, times the square
/// of the distance to what is left, at least half of the size of the box that it stands for.
/// Quadrics do not know that distance: to a planar patch all points of its plane are equally near,
/// and a speck in mid-air has hardly any error left when it shrinks to a point. kWorthKeeping times
/// that.
double vanishing_cost(std::span<const CollapseVertex> vertices, std::span<const LocalFace> faces,
                      std::span<const std::uint32_t> component_vertices,
                      std::span<const std::uint32_t> component_faces, double distance_sq);

}  // namespace hewer::rsimp
