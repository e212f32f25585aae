// SPDX-License-Identifier: MIT
#include "rsimp/vanishing_cost.h"

#include <algorithm>
#include <cmath>

#include "ooc/vec3.h"

namespace hewer::rsimp {

double vanishing_cost(std::span<const CollapseVertex> vertices, std::span<const LocalFace> faces,
                      std::span<const std::uint32_t> component_vertices,
                      std::span<const std::uint32_t> component_faces, double distance_sq) {
    double area = 0;
    for (const std::uint32_t f : component_faces) {
        const LocalFace& t = faces[f];
        const Vec3& a = vertices[t[0]].position;
        const Vec3 normal = cross(vertices[t[1]].position - a, vertices[t[2]].position - a);
        area += 0.5 * std::sqrt(dot(normal, normal));
    }
    std::array<float, 6> box = vertices[component_vertices.front()].box;
    for (const std::uint32_t v : component_vertices) widen(box, vertices[v].box);
    double size_sq = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double d = static_cast<double>(box[3 + k]) - static_cast<double>(box[k]);
        size_sq += d * d;
    }
    return kWorthKeeping * area * std::max(distance_sq, size_sq / 4);
}

}  // namespace hewer::rsimp
