// SPDX-License-Identifier: MIT
/// An independent judge of a mesh's topology: nothing of the product is linked in.
///
///     topology_check MESH.ply [--edges-only]
///
/// Prints JSON. "by_index" takes the vertices as the file has them, "by_position" merges those at
/// equal coordinates first: seams close, and surfaces that touch in an edge show. Edges are counted
/// by sorting them, so that no data structure's idea of a manifold gets in the way; OpenMesh then
/// builds the mesh and tells what it refuses (edges with more than two faces, faces that meet an
/// edge in the same direction, vertices where closed fans touch), unless --edges-only.
///
/// Memory: about 100 bytes a triangle, and OpenMesh's mesh.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/disjoint_sets.h"
#include "tests/bench/openmesh_judge.h"
#include "tests/bench/plain_ply.h"

namespace {

using Ids = std::vector<std::uint32_t>;  ///< three a triangle
using nlohmann::ordered_json;

struct Edge {
    std::uint64_t ends = 0;      ///< smaller id in the high half
    std::int32_t direction = 0;  ///< +1: the face runs from the smaller id to the larger
};

/// Edges of all faces with three different corners, equal ones side by side.
std::vector<Edge> sorted_edges(const Ids& ids) {
    std::vector<Edge> edges;
    edges.reserve(ids.size());
    for (std::size_t t = 0; t < ids.size(); t += 3) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint64_t a = ids[t + corner];
            const std::uint64_t b = ids[t + (corner + 1) % 3];
            edges.push_back(a < b ? Edge{a << 32 | b, 1} : Edge{b << 32 | a, -1});
        }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.ends < b.ends; });
    return edges;
}

Ids without_degenerate(const Ids& ids) {
    Ids kept;
    kept.reserve(ids.size());
    for (std::size_t t = 0; t < ids.size(); t += 3) {
        const bool is_degenerate =
            ids[t] == ids[t + 1] || ids[t + 1] == ids[t + 2] || ids[t + 2] == ids[t];
        if (!is_degenerate) kept.insert(kept.end(), {ids[t], ids[t + 1], ids[t + 2]});
    }
    return kept;
}

/// Faces beyond the first with the same three corners, whatever their winding.
std::uint64_t count_duplicates(const Ids& ids) {
    std::vector<std::array<std::uint32_t, 3>> faces(ids.size() / 3);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        faces[f] = {ids[3 * f], ids[3 * f + 1], ids[3 * f + 2]};
        std::sort(faces[f].begin(), faces[f].end());
    }
    std::sort(faces.begin(), faces.end());
    const auto n_distinct = std::unique(faces.begin(), faces.end()) - faces.begin();
    return faces.size() - static_cast<std::uint64_t>(n_distinct);
}

struct EdgeCounts {
    std::uint64_t edges = 0;
    std::uint64_t border = 0;       ///< one face
    std::uint64_t nonmanifold = 0;  ///< more than two
    std::uint64_t miswound = 0;     ///< two faces that run along it in the same direction
};

EdgeCounts count_edges(const std::vector<Edge>& edges) {
    EdgeCounts counts;
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        std::int32_t direction = 0;
        for (last = first; last < edges.size() && edges[last].ends == edges[first].ends; ++last) {
            direction += edges[last].direction;
        }
        const std::size_t n_faces = last - first;
        ++counts.edges;
        if (n_faces == 1) ++counts.border;
        if (n_faces > 2) ++counts.nonmanifold;
        if (n_faces == 2 && direction != 0) ++counts.miswound;
    }
    return counts;
}

ordered_json describe(const Ids& all_ids, std::size_t n_vertices) {
    const Ids ids = without_degenerate(all_ids);
    std::vector<Edge> edges = sorted_edges(ids);
    const EdgeCounts counts = count_edges(edges);

    std::vector<bool> is_used(n_vertices, false);
    for (const std::uint32_t v : ids) is_used[v] = true;
    const auto n_used =
        static_cast<std::uint64_t>(std::count(is_used.begin(), is_used.end(), true));
    bench::DisjointSets sets(n_vertices);
    std::uint64_t n_components = n_used;
    for (const Edge& edge : edges) {
        const auto a = static_cast<std::uint32_t>(edge.ends >> 32);
        const auto b = static_cast<std::uint32_t>(edge.ends);
        if (sets.join(a, b)) --n_components;
    }
    return {{"border_edges", counts.border},
            {"nonmanifold_edges", counts.nonmanifold},
            {"miswound_edges", counts.miswound},
            {"degenerate_faces", (all_ids.size() - ids.size()) / 3},
            {"duplicate_faces", count_duplicates(ids)},
            {"components", n_components},
            {"euler_characteristic", static_cast<std::int64_t>(n_used) -
                                         static_cast<std::int64_t>(counts.edges) +
                                         static_cast<std::int64_t>(ids.size() / 3)}};
}

/// The same triangles, each vertex replaced by the first at its position (-0 equals 0).
Ids merge_equal_positions(const bench::PlainMesh& mesh) {
    const std::vector<std::uint32_t> first = bench::first_at_position(mesh);
    Ids merged = mesh.indices;
    for (std::uint32_t& v : merged) v = first[v];
    return merged;
}

std::uint64_t count_unused_vertices(const bench::PlainMesh& mesh) {
    std::vector<bool> is_used(mesh.positions.size() / 3, false);
    for (const std::uint32_t v : mesh.indices) is_used[v] = true;
    return static_cast<std::uint64_t>(std::count(is_used.begin(), is_used.end(), false));
}

/// Faces whose corners are different vertices on one line.
std::uint64_t count_zero_area(const bench::PlainMesh& mesh) {
    std::uint64_t count = 0;
    const auto corner = [&](std::size_t i, std::size_t axis) {
        return static_cast<double>(mesh.positions[std::size_t{3} * mesh.indices[i] + axis]);
    };
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::array<double, 3> u{};
        std::array<double, 3> v{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            u[axis] = corner(t + 1, axis) - corner(t, axis);
            v[axis] = corner(t + 2, axis) - corner(t, axis);
        }
        const bool is_flat =
            u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
        if (is_flat) ++count;
    }
    return count;
}

}  // namespace

int main(int argc, char** argv) {
    const bool is_edges_only = argc == 3 && std::string(argv[2]) == "--edges-only";
    if (argc != 2 && !is_edges_only) {
        std::fputs("usage: topology_check MESH.ply [--edges-only]\n", stderr);
        return 2;
    }
    try {
        const bench::PlainMesh mesh = bench::read_plain_ply(argv[1]);
        const std::size_t n_vertices = mesh.positions.size() / 3;
        ordered_json report{{"vertices", n_vertices},
                            {"triangles", mesh.indices.size() / 3},
                            {"unused_vertices", count_unused_vertices(mesh)},
                            {"zero_area_faces", count_zero_area(mesh)},
                            {"by_index", describe(mesh.indices, n_vertices)},
                            {"by_position", describe(merge_equal_positions(mesh), n_vertices)}};
        if (!is_edges_only) {
            const bench::OpenMeshVerdict verdict = bench::judge_with_openmesh(mesh);
            report["openmesh"] = {{"refused_faces", verdict.refused_faces},
                                  {"border_edges", verdict.border_edges},
                                  {"nonmanifold_vertices", verdict.nonmanifold_vertices}};
        }
        std::puts(report.dump(2).c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "topology_check: %s\n", error.what());
        return 1;
    }
    return 0;
}
