// SPDX-License-Identifier: MIT
#include "ooc/triangle_foot.h"

#include <algorithm>
#include <cstddef>

namespace hewer {

TriangleFoot foot_of(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 ap = p - a;
    const double ab_ab = dot(ab, ab);
    const double ab_ac = dot(ab, ac);
    const double ac_ac = dot(ac, ac);
    const double along_b = dot(ap, ab);
    const double along_c = dot(ap, ac);
    const double det = ab_ab * ac_ac - ab_ac * ab_ac;
    if (det > 1e-10 * ab_ab * ac_ac) {
        const double v = (ac_ac * along_b - ab_ac * along_c) / det;
        const double w = (ab_ab * along_c - ab_ac * along_b) / det;
        if (v >= 0 && w >= 0 && v + w <= 1) return {{1 - v - w, v, w}, true};
    }
    TriangleFoot best{};
    double least = -1;
    const auto try_edge = [&](std::size_t from, std::size_t to, const Vec3& start,
                              const Vec3& end) {
        const Vec3 edge = end - start;
        const double length = dot(edge, edge);
        const double t = length > 0 ? std::clamp(dot(p - start, edge) / length, 0.0, 1.0) : 0;
        const Vec3 d = p - (start + t * edge);
        const double squared = dot(d, d);
        if (least >= 0 && squared >= least) return;
        least = squared;
        best = {};
        best.weights[from] = 1 - t;
        best.weights[to] += t;
    };
    try_edge(0, 1, a, b);
    try_edge(1, 2, b, c);
    try_edge(2, 0, c, a);
    return best;
}

}  // namespace hewer
