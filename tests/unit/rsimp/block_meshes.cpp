// SPDX-License-Identifier: MIT
#include "tests/unit/rsimp/block_meshes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "cluster/uniform_grid.h"
#include "ooc/vec3.h"

namespace hewer::test {

namespace {

std::vector<rsimp::CollapseVertex> vertices_of(const Mesh& mesh) {
    std::vector<rsimp::CollapseVertex> vertices(mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        vertices[v].position = mesh.positions[v];
        for (std::size_t i = 0; i < 3; ++i) {
            const auto x = static_cast<float>(mesh.positions[v][i]);
            vertices[v].box[i] = x - 0.5F;
            vertices[v].box[3 + i] = x + 0.5F;
        }
    }
    const auto add = [&](std::uint64_t v, const Vec3& n, double d, double weight) {
        cluster::Quadric q;
        q.a = {weight * n[0] * n[0], weight * n[0] * n[1], weight * n[0] * n[2],
               weight * n[1] * n[1], weight * n[1] * n[2], weight * n[2] * n[2]};
        q.b = (weight * d) * n;
        q.c = weight * d * d;
        vertices[v].quadric += q;
    };
    std::map<std::pair<std::uint64_t, std::uint64_t>, int> n_faces;
    for (const Triangle& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) ++n_faces[std::minmax(t[i], t[(i + 1) % 3])];
    }
    for (const Triangle& t : mesh.triangles) {
        const Vec3 normal = cross_of(mesh, t);
        const double length = std::sqrt(dot(normal, normal));
        if (!(length > 0)) continue;
        const Vec3 n = (1 / length) * normal;
        for (std::size_t i = 0; i < 3; ++i) {
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
    return vertices;
}

}  // namespace

rsimp::BlockMesh raw_block(const Mesh& mesh) {
    rsimp::BlockMesh block;
    const auto vertices = vertices_of(mesh);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        block.vertices.push_back(
            {rsimp::vertex_id(v, 0), vertices[v], 1, rsimp::VertexFlags::kRaw});
    }
    for (const Triangle& t : mesh.triangles) {
        block.faces.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                               static_cast<std::uint32_t>(t[2])});
    }
    return block;
}

rsimp::BlockMesh free_block(const Mesh& mesh) {
    rsimp::BlockMesh block = raw_block(mesh);
    for (rsimp::StoredVertex& v : block.vertices) v.flags = 0;
    return block;
}

Mesh to_mesh(const rsimp::BlockMesh& block) {
    Mesh mesh;
    for (const rsimp::StoredVertex& v : block.vertices) mesh.positions.push_back(v.vertex.position);
    for (const rsimp::LocalFace& t : block.faces) mesh.triangles.push_back({t[0], t[1], t[2]});
    return mesh;
}

Mesh to_mesh(const rsimp::MeshStore& store) {
    rsimp::BlockMesh block;
    block.vertices.resize(store.vertices.size());
    store.vertices.read(0, block.vertices);
    std::vector<rsimp::Face> faces(store.faces.size());
    store.faces.read(0, faces);
    for (const rsimp::Face& face : faces) block.faces.push_back(rsimp::local_face(block, face));
    return to_mesh(block);
}

rsimp::ClusterMesh cluster_mesh(ooc::Context& context, const Mesh& mesh, std::uint64_t most,
                                bool is_closed) {
    const auto vertices = vertices_of(mesh);
    const auto code_of = [&](std::uint32_t v) {
        std::uint64_t key = 0;
        for (unsigned i = 0; i < 3; ++i) {
            key |= static_cast<std::uint64_t>(mesh.positions[v][i]) << (21 * i);
        }
        return cluster::morton(key);
    };
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return code_of(a) < code_of(b); });
    std::vector<std::uint32_t> id(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) id[order[i]] = i;

    rsimp::ClusterMesh result;
    result.is_closed = is_closed;
    result.vertices = {context, "test"};
    result.n_cells = {context, "test"};
    result.faces = {context, "test"};
    for (const std::uint32_t v : order) {
        result.vertices.push(vertices[v]);
        result.n_cells.push(1);
    }
    // Boxes: as deep as needed.
    struct Range {
        std::size_t first;
        std::size_t last;
        unsigned shift;
    };
    std::vector<Range> open{{0, order.size(), 63}};
    std::vector<std::size_t> starts;
    while (!open.empty()) {
        const Range r = open.back();
        open.pop_back();
        if (r.first == r.last) continue;
        if (r.last - r.first <= most || r.shift == 0) {
            result.blocks.push_back(
                {{code_of(order[r.first]) >> r.shift << r.shift, r.shift}, r.first, 0});
            continue;
        }
        std::vector<Range> children;
        for (std::size_t i = r.first; i < r.last;) {
            const std::uint64_t prefix = code_of(order[i]) >> (r.shift - 3);
            std::size_t j = i;
            while (j < r.last && code_of(order[j]) >> (r.shift - 3) == prefix) ++j;
            children.push_back({i, j, r.shift - 3});
            i = j;
        }
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    std::vector<std::vector<rsimp::CellTriple>> faces(result.blocks.size());
    for (const Triangle& t : mesh.triangles) {
        rsimp::CellTriple c{id[t[0]], id[t[1]], id[t[2]]};
        if (c[0] == c[1] || c[1] == c[2] || c[0] == c[2]) continue;
        std::size_t b = 0;
        while (b + 1 < result.blocks.size() && result.blocks[b + 1].first_cluster <= c[0]) ++b;
        faces[b].push_back(c);
    }
    for (std::size_t b = 0; b < faces.size(); ++b) {
        result.blocks[b].first_face = result.faces.size();
        result.faces.append(faces[b]);
    }
    result.blocks.push_back({{}, order.size(), result.faces.size()});
    return result;
}

}  // namespace hewer::test
