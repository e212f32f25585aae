// SPDX-License-Identifier: MIT
#include "tests/unit/rsimp/stored_mesh.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "ooc/vec3.h"
#include "tests/support/shapes.h"

namespace hewer::test {

namespace {

std::vector<std::size_t> order_of(const std::vector<rsimp::VertexId>& ids) {
    std::vector<std::size_t> order(ids.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return ids[a] < ids[b]; });
    return order;
}

}  // namespace

std::vector<rsimp::VertexId> random_ids(std::uint64_t n, std::uint64_t seed) {
    Random random(seed);
    std::set<rsimp::VertexId> ids;
    while (ids.size() < n) {
        const std::uint64_t cluster = 1000 + random.below(2 * n + 1);
        ids.insert(rsimp::vertex_id(cluster, cluster % 3 == 0 ? random.below(4) : 0));
    }
    std::vector<rsimp::VertexId> result(ids.begin(), ids.end());
    for (std::size_t i = result.size(); i > 1; --i) {
        std::swap(result[i - 1], result[random.below(i)]);
    }
    return result;
}

rsimp::MeshStore store_mesh(ooc::Context& context, const Mesh& mesh,
                            const std::vector<rsimp::VertexId>& ids) {
    rsimp::MeshStore store;
    store.origin = kStoreOrigin;
    store.vertices = {context, "vertices"};
    store.attributes.sums = {context, "attributes"};
    store.faces = {context, "faces"};
    for (const std::size_t v : order_of(ids)) {
        rsimp::StoredVertex record{};
        record.id = ids[v];
        record.n_cells = 1;
        record.vertex.position = mesh.positions[v] - kStoreOrigin;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto x = static_cast<float>(record.vertex.position[i]);
            record.vertex.box[i] = x - 0.625F;
            record.vertex.box[i + 3] = x + 0.375F;
        }
        store.vertices.push(record);
        if (mesh.normals.empty() && mesh.colors.empty()) continue;
        cluster::CellAttributes a{};
        if (!mesh.normals.empty()) {
            for (std::size_t i = 0; i < 3; ++i) a.normal[i] = 2 * mesh.normals[v][i];
        }
        if (!mesh.colors.empty()) {
            a.n_colors = 3;
            for (std::size_t i = 0; i < 4; ++i) {
                a.color[i] = 3 * static_cast<float>(mesh.colors[v][i]);
            }
        }
        store.attributes.sums.push(a);
    }
    std::vector<rsimp::Face> faces;
    for (const Triangle& t : mesh.triangles) {
        rsimp::Face face{ids[t[0]], ids[t[1]], ids[t[2]]};
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        faces.push_back(face);
    }
    std::sort(faces.begin(), faces.end());
    store.faces.append(faces);
    return store;
}

Mesh sorted_by_id(const Mesh& mesh, const std::vector<rsimp::VertexId>& ids) {
    const std::vector<std::size_t> order = order_of(ids);
    std::vector<std::uint64_t> place(order.size());
    Mesh result;
    for (std::size_t i = 0; i < order.size(); ++i) {
        place[order[i]] = i;
        result.positions.push_back(mesh.positions[order[i]]);
        if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[order[i]]);
        if (!mesh.colors.empty()) result.colors.push_back(mesh.colors[order[i]]);
    }
    for (const Triangle& t : mesh.triangles) {
        result.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    }
    return result;
}

std::uint64_t count_components(const Mesh& mesh) {
    std::vector<std::vector<std::uint64_t>> neighbours(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            neighbours[t[i]].push_back(t[(i + 1) % 3]);
            neighbours[t[(i + 1) % 3]].push_back(t[i]);
        }
    }
    std::vector<bool> is_seen(neighbours.size());
    std::uint64_t n = 0;
    for (std::uint64_t v = 0; v < neighbours.size(); ++v) {
        if (is_seen[v]) continue;
        ++n;
        std::vector<std::uint64_t> stack{v};
        is_seen[v] = true;
        while (!stack.empty()) {
            const std::uint64_t u = stack.back();
            stack.pop_back();
            for (const std::uint64_t w : neighbours[u]) {
                if (!is_seen[w]) stack.push_back(w);
                is_seen[w] = true;
            }
        }
    }
    return n;
}

}  // namespace hewer::test
