// SPDX-License-Identifier: MIT
/// A mesh as the finishing collapse takes it, with quadrics of its own triangles and borders.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/edge_collapse.h"
#include "tests/support/mesh_checks.h"

namespace hewer::test {

/// Coordinates are taken to be in cells.
inline rsimp::CollapseMesh collapse_mesh(ooc::Context& context, const Mesh& mesh) {
    rsimp::CollapseMesh result;
    result.triangles = {context.budget(), "test", mesh.triangles.size()};
    result.vertices = {context.budget(), "test", mesh.positions.size()};
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        result.vertices[v].position = mesh.positions[v];
        for (std::size_t i = 0; i < 3; ++i) {
            const auto x = static_cast<float>(mesh.positions[v][i]);
            result.vertices[v].box[i] = x - 0.5F;
            result.vertices[v].box[3 + i] = x + 0.5F;
        }
    }
    const auto add = [&](std::uint64_t v, const Vec3& n, double d, double weight) {
        cluster::Quadric q;
        q.a = {weight * n[0] * n[0], weight * n[0] * n[1], weight * n[0] * n[2],
               weight * n[1] * n[1], weight * n[1] * n[2], weight * n[2] * n[2]};
        q.b = (weight * d) * n;
        q.c = weight * d * d;
        result.vertices[v].quadric += q;
    };
    std::map<std::pair<std::uint64_t, std::uint64_t>, int> n_faces;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) ++n_faces[std::minmax(t[i], t[(i + 1) % 3])];
    }
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        const Vec3 normal = cross_of(mesh, t);
        const double length = std::sqrt(dot(normal, normal));
        const Vec3 n = (1 / length) * normal;
        for (std::size_t i = 0; i < 3; ++i) {
            result.triangles[f][i] = static_cast<std::uint32_t>(t[i]);
            add(t[i], n, -dot(n, mesh.positions[t[i]]), length / 6);
            const std::uint64_t next = t[(i + 1) % 3];
            if (n_faces[std::minmax(t[i], next)] != 1) continue;
            const Vec3 edge = mesh.positions[next] - mesh.positions[t[i]];
            const Vec3 side = cross(edge, n);
            const Vec3 s = (1 / std::sqrt(dot(side, side))) * side;
            for (const std::uint64_t v : {t[i], next}) {
                add(v, s, -dot(s, mesh.positions[v]), dot(edge, edge));
            }
        }
    }
    return result;
}

/// What is left of it.
inline Mesh live_mesh(const rsimp::EdgeCollapse& collapse) {
    Mesh mesh;
    std::vector<std::uint64_t> index(collapse.mesh().vertices.size());
    for (std::uint32_t v = 0; v < index.size(); ++v) {
        if (!collapse.is_live(v)) continue;
        index[v] = mesh.positions.size();
        mesh.positions.push_back(collapse.mesh().vertices[v].position);
    }
    for (std::uint64_t t = 0; t < collapse.mesh().triangles.size(); ++t) {
        if (!collapse.is_live_triangle(t)) continue;
        const auto& c = collapse.mesh().triangles[t];
        mesh.triangles.push_back({index[c[0]], index[c[1]], index[c[2]]});
    }
    return mesh;
}

}  // namespace hewer::test
