// SPDX-License-Identifier: MIT
/// What an edge costs and where its vertex goes, by the quadrics of its ends alone.
#pragma once

#include <algorithm>

#include "cluster/attribute_quadric.h"
#include "rsimp/cluster_mesh.h"

namespace hewer::rsimp {

/// The sum of two vertices' quadrics, of attributes too where they count, with its minimum, pulled
/// a little towards the area-weighted mean of the ends and clamped to the box of the cells that
/// both stand for.
struct EdgeQuadric {
    cluster::Quadric quadric;
    Vec3 optimum{};
    Vec3 low{};  ///< of the box
    Vec3 high{};
    double length_cost = 0;

    EdgeQuadric(const CollapseVertex& u, const CollapseVertex& v);
    EdgeQuadric(const CollapseVertex& u, const CollapseVertex& v,
                const cluster::AttributeQuadric& attributes_u,
                const cluster::AttributeQuadric& attributes_v);

    [[nodiscard]] double cost(const Vec3& x) const {
        return std::max(0.0, quadric.error(x)) + length_cost;
    }

  private:
    void place(const CollapseVertex& u, const CollapseVertex& v);
};

}  // namespace hewer::rsimp
