// SPDX-License-Identifier: MIT
#include "rsimp/edge_quadric.h"

#include "ooc/vec3.h"

namespace hewer::rsimp {

namespace {

// Pull towards the area-weighted mean of the two ends, relative to the quadric's trace: decides
// where the planes do not. On a flat patch it keeps triangles even.
constexpr double kPull = 1e-3;
// Cost of an edge's length, relative to trace times squared length: among equals the shortest goes
// first.
constexpr double kLengthCost = 1e-6;

/// Minimum of q with the pull towards `anchor`.
Vec3 pulled_minimum(const cluster::Quadric& q, const Vec3& anchor) {
    const Vec3 g = q.a * anchor + q.b;
    const double mu = kPull * q.trace() + 1e-12;
    const double xx = q.a[0] + mu;
    const double xy = q.a[1];
    const double xz = q.a[2];
    const double yy = q.a[3] + mu;
    const double yz = q.a[4];
    const double zz = q.a[5] + mu;
    // Cofactors; the matrix is positive definite.
    const double c00 = yy * zz - yz * yz;
    const double c01 = xz * yz - xy * zz;
    const double c02 = xy * yz - xz * yy;
    const double det = xx * c00 + xy * c01 + xz * c02;
    if (!(det > 0)) return anchor;
    const double c11 = xx * zz - xz * xz;
    const double c12 = xy * xz - xx * yz;
    const double c22 = xx * yy - xy * xy;
    const double r = -1 / det;
    return anchor + Vec3{r * (c00 * g[0] + c01 * g[1] + c02 * g[2]),
                         r * (c01 * g[0] + c11 * g[1] + c12 * g[2]),
                         r * (c02 * g[0] + c12 * g[1] + c22 * g[2])};
}

}  // namespace

EdgeQuadric::EdgeQuadric(const CollapseVertex& u, const CollapseVertex& v) : quadric(u.quadric) {
    quadric += v.quadric;
    place(u, v);
}

EdgeQuadric::EdgeQuadric(const CollapseVertex& u, const CollapseVertex& v,
                         const cluster::AttributeQuadric& attributes_u,
                         const cluster::AttributeQuadric& attributes_v)
    : quadric(u.quadric) {
    quadric += v.quadric;
    cluster::AttributeQuadric attributes = attributes_u;
    attributes += attributes_v;
    quadric += attributes.reduced();
    place(u, v);
}

void EdgeQuadric::place(const CollapseVertex& u, const CollapseVertex& v) {
    const double wu = u.quadric.trace() + 1e-12;
    const double wv = v.quadric.trace() + 1e-12;
    optimum = pulled_minimum(quadric, (1 / (wu + wv)) * (wu * u.position + wv * v.position));
    for (std::size_t i = 0; i < 3; ++i) {
        low[i] = static_cast<double>(std::min(u.box[i], v.box[i]));
        high[i] = static_cast<double>(std::max(u.box[3 + i], v.box[3 + i]));
        optimum[i] = std::min(std::max(optimum[i], low[i]), high[i]);
    }
    const Vec3 edge = v.position - u.position;
    length_cost = kLengthCost * (wu + wv) * dot(edge, edge);
}

}  // namespace hewer::rsimp
