// SPDX-License-Identifier: MIT
#include "mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ooc/vec3.h"

namespace hewer::test {

namespace {

/// Whether the faces around one vertex, given as pairs of its neighbours, hang together by shared
/// neighbours.
bool is_one_fan(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& faces) {
    std::set<std::size_t> open;
    for (std::size_t i = 1; i < faces.size(); ++i) open.insert(i);
    std::vector<std::size_t> reached{0};
    while (!reached.empty()) {
        const auto [a, b] = faces[reached.back()];
        reached.pop_back();
        for (auto i = open.begin(); i != open.end();) {
            const auto [c, d] = faces[*i];
            if (a == c || a == d || b == c || b == d) {
                reached.push_back(*i);
                i = open.erase(i);
            } else {
                ++i;
            }
        }
    }
    return open.empty();
}

}  // namespace

Counts count(std::span<const Triangle> triangles, std::uint64_t n_vertices) {
    Counts result;
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::pair<int, int>> edges;
    std::set<Triangle> seen;
    std::vector<std::vector<std::pair<std::uint64_t, std::uint64_t>>> around(n_vertices);
    for (const Triangle& t : triangles) {
        if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) ++result.degenerate;
        Triangle sorted = t;
        std::sort(sorted.begin(), sorted.end());
        if (!seen.insert(sorted).second) ++result.duplicates;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint64_t a = t[i];
            const std::uint64_t b = t[(i + 1) % 3];
            auto& [forward, backward] = edges[std::minmax(a, b)];
            ++(a < b ? forward : backward);
            around.at(a).emplace_back(b, t[(i + 2) % 3]);
        }
    }
    std::set<std::uint64_t> nonmanifold;
    std::map<std::uint64_t, std::vector<std::uint64_t>> border;
    for (const auto& [edge, faces] : edges) {
        const int n = faces.first + faces.second;
        if (n == 1) {
            ++result.border_edges;
            border[edge.first].push_back(edge.second);
            border[edge.second].push_back(edge.first);
        }
        if (n > 2) {
            ++result.nonmanifold_edges;
            nonmanifold.insert({edge.first, edge.second});
        }
        if (n == 2 && faces.first != 1) ++result.unlike_edges;
    }
    for (std::uint64_t v = 0; v < n_vertices; ++v) {
        if (around[v].empty()) {
            ++result.unreferenced;
        } else if (!is_one_fan(around[v])) {
            ++result.split_fans;
            nonmanifold.insert(v);
        }
    }
    result.nonmanifold_vertices = nonmanifold.size();
    while (!border.empty()) {
        ++result.border_loops;
        std::vector<std::uint64_t> reached{border.begin()->first};
        while (!reached.empty()) {
            const auto it = border.find(reached.back());
            reached.pop_back();
            if (it == border.end()) continue;
            reached.insert(reached.end(), it->second.begin(), it->second.end());
            border.erase(it);
        }
    }
    result.edges = edges.size();
    result.euler = static_cast<std::int64_t>(n_vertices - result.unreferenced) -
                   static_cast<std::int64_t>(edges.size()) +
                   static_cast<std::int64_t>(triangles.size());
    return result;
}

std::set<Triangle> triangle_set(std::span<const Triangle> triangles) {
    std::set<Triangle> result;
    for (Triangle t : triangles) {
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        result.insert(t);
    }
    return result;
}

Vec3 cross_of(const Mesh& mesh, const Triangle& t) {
    const Vec3& p = mesh.positions[t[0]];
    return cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
}

double area(const Mesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n = cross_of(mesh, t);
        sum += 0.5 * std::sqrt(dot(n, n));
    }
    return sum;
}

double plane_error(const Mesh& mesh, const Vec3& x) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n = cross_of(mesh, t);
        const double length = std::sqrt(dot(n, n));
        if (!(length > 0)) continue;
        const double distance = dot(n, x - mesh.positions[t[0]]) / length;
        sum += 0.5 * length * distance * distance;
    }
    return sum;
}

Bounds bounds_of(const Mesh& mesh) {
    Bounds bounds;
    for (const Vec3& p : mesh.positions) bounds.extend(p);
    return bounds;
}

}  // namespace hewer::test
