// SPDX-License-Identifier: MIT
#include "rsimp/block_mesh.h"

#include <algorithm>
#include <numeric>

namespace hewer::rsimp {

std::uint32_t find_vertex(const BlockMesh& mesh, VertexId id) {
    const auto it = std::partition_point(mesh.vertices.begin(), mesh.vertices.end(),
                                         [&](const StoredVertex& v) { return v.id < id; });
    return static_cast<std::uint32_t>(it - mesh.vertices.begin());
}

Face global_face(const BlockMesh& mesh, const LocalFace& t) {
    // Places rise with the ids.
    const std::size_t i = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    return {mesh.vertices[t[i]].id, mesh.vertices[t[(i + 1) % 3]].id,
            mesh.vertices[t[(i + 2) % 3]].id};
}

void keep_vertices(BlockMesh& mesh, const std::vector<bool>& is_kept) {
    std::vector<std::uint32_t> new_index(mesh.vertices.size(), kNoIndex);
    std::uint32_t n = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (!is_kept[v]) continue;
        mesh.vertices[n] = mesh.vertices[v];
        mesh.attributes.copy(v, n);
        new_index[v] = n++;
    }
    mesh.vertices.resize(n);
    mesh.attributes.truncate(n);
    for (LocalFace& face : mesh.faces) {
        for (std::uint32_t& v : face) v = new_index[v];
    }
}

void sort_vertices(BlockMesh& mesh) {
    const auto by_id = [](const StoredVertex& a, const StoredVertex& b) { return a.id < b.id; };
    if (std::is_sorted(mesh.vertices.begin(), mesh.vertices.end(), by_id)) return;
    std::vector<std::uint32_t> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto is_before = [&](std::uint32_t a, std::uint32_t b) {
        return by_id(mesh.vertices[a], mesh.vertices[b]);
    };
    // Most often the first ones are in order: what has been added comes after them.
    const auto added = std::is_sorted_until(order.begin(), order.end(), is_before);
    std::sort(added, order.end(), is_before);
    std::inplace_merge(order.begin(), added, order.end(), is_before);
    std::vector<StoredVertex> vertices(order.size());
    std::vector<std::uint32_t> new_index(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        vertices[i] = mesh.vertices[order[i]];
        new_index[order[i]] = i;
    }
    mesh.vertices = std::move(vertices);
    mesh.attributes.reorder(order);
    for (LocalFace& face : mesh.faces) {
        for (std::uint32_t& v : face) v = new_index[v];
    }
}

}  // namespace hewer::rsimp
