// SPDX-License-Identifier: MIT
#include "rsimp/fan_vertices.h"

#include <algorithm>
#include <cmath>

#include "ooc/vec3.h"

namespace hewer::rsimp {

namespace {

// How far fans move towards their own neighbours, as a share of the way, so that sheets do not
// touch.
constexpr double kNudge = 0.02;
// But at most so far, in cells: the neighbours of a huge triangle's corner are far away.
constexpr double kFarthestNudge = 0.25;

struct Nudge {
    Vec3 pull{};  // sum of the vectors to the neighbours
    double n = 0;
    Vec3 normal{};  // of the fan, as long as its area
};

}  // namespace

std::uint64_t add_fan_vertices(BlockMesh& mesh, const std::vector<std::uint32_t>& extra,
                               std::uint64_t* next_fan) {
    if (extra.empty()) return 0;
    const std::size_t n_before = mesh.vertices.size();
    mesh.vertices.reserve(n_before + extra.size());
    std::vector<std::uint32_t> n_fans(n_before, 1);
    for (const std::uint32_t v : extra) {
        StoredVertex fan = mesh.vertices[v];
        const std::uint64_t number = n_fans[v]++;
        fan.id = vertex_id(cluster_of(fan.id), next_fan != nullptr ? (*next_fan)++ : number);
        fan.n_cells = 0;  // the first fan answers for the cells
        mesh.vertices.push_back(fan);
        mesh.attributes.repeat(v);
    }
    const auto origin = [&](std::uint32_t v) { return v < n_before ? v : extra[v - n_before]; };
    std::vector<Nudge> nudges(mesh.vertices.size());
    for (const LocalFace& t : mesh.faces) {
        const std::array<Vec3, 3> p{mesh.position(t[0]), mesh.position(t[1]), mesh.position(t[2])};
        const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
        for (std::size_t i = 0; i < 3; ++i) {
            if (n_fans[origin(t[i])] < 2) continue;
            Nudge& nudge = nudges[t[i]];
            nudge.pull = nudge.pull + (p[(i + 1) % 3] - p[i]) + (p[(i + 2) % 3] - p[i]);
            nudge.n += 2;
            nudge.normal = nudge.normal + normal;
        }
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        const std::uint32_t n = n_fans[origin(v)];
        if (n < 2) continue;
        CollapseVertex& vertex = mesh.vertices[v].vertex;
        const double share = 1.0 / n;
        for (double& x : vertex.quadric.a) x *= share;
        for (double& x : vertex.quadric.b) x *= share;
        vertex.quadric.c *= share;
        if (!mesh.attributes.quadrics.empty()) mesh.attributes.quadrics[v] *= share;
        const Nudge& nudge = nudges[v];
        if (nudge.n == 0) continue;
        Vec3 step = (kNudge / nudge.n) * nudge.pull;
        const double area = std::sqrt(dot(nudge.normal, nudge.normal));
        if (area > 0) step = step + (kNudge / 4 / std::sqrt(area)) * nudge.normal;
        const double length = std::sqrt(dot(step, step));
        if (length > kFarthestNudge) step = (kFarthestNudge / length) * step;
        vertex.position = vertex.position + step;
    }
    return static_cast<std::uint64_t>(
        std::count_if(n_fans.begin(), n_fans.end(), [](std::uint32_t n) { return n > 1; }));
}

}  // namespace hewer::rsimp
