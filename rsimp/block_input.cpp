// SPDX-License-Identifier: MIT
#include "rsimp/block_input.h"

#include <algorithm>

#include "ooc/spool.h"

namespace hewer::rsimp {

namespace {

Face smallest_first(const Face& t) {
    const std::size_t i = t[0] < t[1] ? (t[0] < t[2] ? 0 : 2) : (t[1] < t[2] ? 1 : 2);
    return {t[i], t[(i + 1) % 3], t[(i + 2) % 3]};
}

}  // namespace

ClusterInput::ClusterInput(const ClusterMesh& mesh) : mesh_(mesh), counts_(mesh.n_blocks()) {
    for (std::size_t b = 0; b < counts_.size(); ++b) {
        counts_[b] = mesh.blocks[b + 1].first_cluster - mesh.blocks[b].first_cluster;
    }
}

BlockMesh ClusterInput::load(std::size_t first, std::size_t last) const {
    const std::uint64_t begin = mesh_.blocks[first].first_cluster;
    const std::uint64_t end = mesh_.blocks[last].first_cluster;
    const std::uint64_t n = end - begin;
    BlockMesh mesh;
    {
        std::vector<CollapseVertex> vertices(n);
        std::vector<std::uint32_t> n_cells(n);
        mesh_.vertices.read(begin, vertices);
        mesh_.n_cells.read(begin, n_cells);
        mesh.vertices.reserve(n);
        for (std::uint64_t i = 0; i < n; ++i) {
            mesh.vertices.push_back(
                {vertex_id(begin + i, 0), vertices[i], n_cells[i], VertexFlags::kRaw});
        }
    }
    mesh_.attributes.read(begin, n, mesh.attributes);
    ooc::SpoolReader<CellTriple> faces(mesh_.faces, mesh_.blocks[first].first_face,
                                       mesh_.blocks[last].first_face);
    while (const CellTriple* face = faces.next()) {
        LocalFace local;
        bool is_inside = true;
        for (std::size_t i = 0; i < 3; ++i) {
            is_inside &= (*face)[i] >= begin && (*face)[i] < end;
            local[i] = static_cast<std::uint32_t>((*face)[i] - begin);
        }
        if (is_inside) mesh.faces.push_back(local);
    }
    ooc::SpoolReader<ClusterMesh::Link> links(mesh_.links, mesh_.blocks[first].first_link,
                                              mesh_.blocks[last].first_link);
    while (const ClusterMesh::Link* link = links.next()) {
        const auto [low, high] = *link;
        if (low < begin || high >= end) continue;
        mesh.faces.push_back({static_cast<std::uint32_t>(low - begin),
                              static_cast<std::uint32_t>(high - begin),
                              static_cast<std::uint32_t>(high - begin)});
    }
    return mesh;
}

std::vector<Face> ClusterInput::crossing(std::size_t first, std::size_t last) const {
    const std::uint64_t begin = mesh_.blocks[first].first_cluster;
    const std::uint64_t end = mesh_.blocks[last].first_cluster;
    std::vector<Face> crossing;
    ooc::SpoolReader<CellTriple> faces(mesh_.faces, mesh_.blocks[first].first_face,
                                       mesh_.blocks[last].first_face);
    while (const CellTriple* face = faces.next()) {
        const auto [low, high] = std::minmax({(*face)[0], (*face)[1], (*face)[2]});
        if (low >= begin && high < end) continue;
        crossing.push_back(smallest_first(
            {vertex_id((*face)[0], 0), vertex_id((*face)[1], 0), vertex_id((*face)[2], 0)}));
    }
    return crossing;
}

StoreInput::StoreInput(const MeshStore& mesh, std::span<const std::uint64_t> first_cluster)
    : mesh_(mesh),
      first_cluster_(first_cluster.begin(), first_cluster.end()),
      counts_(first_cluster.size() - 1) {
    std::size_t box = 0;
    first_vertex_.push_back(0);
    first_face_.push_back(0);
    std::uint64_t n = 0;
    ooc::SpoolReader<StoredVertex> vertices(mesh.vertices);
    while (const StoredVertex* v = vertices.next()) {
        while (cluster_of(v->id) >= first_cluster_[box + 1]) {
            first_vertex_.push_back(n);
            ++box;
        }
        ++counts_[box];
        ++n;
    }
    first_vertex_.resize(first_cluster.size(), n);
    box = 0;
    n = 0;
    ooc::SpoolReader<Face> faces(mesh.faces);
    while (const Face* face = faces.next()) {
        while (cluster_of((*face)[0]) >= first_cluster_[box + 1]) {
            first_face_.push_back(n);
            ++box;
        }
        ++n;
    }
    first_face_.resize(first_cluster.size(), n);
}

BlockMesh StoreInput::load(std::size_t first, std::size_t last) const {
    BlockMesh mesh;
    mesh.vertices.resize(first_vertex_[last] - first_vertex_[first]);
    mesh_.vertices.read(first_vertex_[first], mesh.vertices);
    for (StoredVertex& v : mesh.vertices) v.flags = 0;
    mesh_.attributes.read(first_vertex_[first], mesh.vertices.size(), mesh.attributes);
    const VertexId end = vertex_id(first_cluster_[last], 0);
    ooc::SpoolReader<Face> faces(mesh_.faces, first_face_[first], first_face_[last]);
    while (const Face* face = faces.next()) {
        if ((*face)[1] >= end || (*face)[2] >= end) continue;  // [0] is the smallest
        mesh.faces.push_back(local_face(mesh, *face));
    }
    return mesh;
}

std::vector<Face> StoreInput::crossing(std::size_t first, std::size_t last) const {
    const VertexId end = vertex_id(first_cluster_[last], 0);
    std::vector<Face> crossing;
    ooc::SpoolReader<Face> faces(mesh_.faces, first_face_[first], first_face_[last]);
    while (const Face* face = faces.next()) {
        if ((*face)[1] >= end || (*face)[2] >= end) crossing.push_back(*face);
    }
    return crossing;
}

}  // namespace hewer::rsimp
