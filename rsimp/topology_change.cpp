// SPDX-License-Identifier: MIT
#include "rsimp/topology_change.h"

#include <algorithm>
#include <array>

#include "rsimp/edge_quadric.h"
#include "rsimp/face_components.h"
#include "rsimp/manifold.h"
#include "rsimp/mesh_merge.h"

namespace hewer::rsimp {

namespace {

std::uint64_t excess(std::uint64_t have, std::uint64_t most) {
    return have > most ? have - most : 0;
}

/// Each vertex's partner, kNoIndex for those that stay alone: the cheapest edges first.
std::vector<std::uint32_t> pair_vertices(const BlockMesh& mesh, std::uint64_t n_pairs) {
    struct Candidate {
        double cost;
        std::uint32_t u;
        std::uint32_t v;
    };
    std::vector<Candidate> candidates;
    for (const LocalFace& t : mesh.faces) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [u, v] = std::minmax(t[i], t[(i + 1) % 3]);
            const EdgeQuadric edge(mesh.vertices[u].vertex, mesh.vertices[v].vertex);
            candidates.push_back({edge.cost(edge.optimum), u, v});
        }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        if (a.cost != b.cost) return a.cost < b.cost;
        return a.u != b.u ? a.u < b.u : a.v < b.v;
    });
    std::vector<std::uint32_t> partner(mesh.vertices.size(), kNoIndex);
    for (const Candidate& c : candidates) {
        if (n_pairs == 0) break;
        if (partner[c.u] != kNoIndex || partner[c.v] != kNoIndex) continue;
        partner[c.u] = c.v;
        partner[c.v] = c.u;
        --n_pairs;
    }
    return partner;
}

}  // namespace

WholeMesh::WholeMesh(ooc::Context& context, const MeshStore& store)
    : context_(context),
      bytes_(
          context.budget().reserve("the whole mesh, to change its topology",
                                   2 * (store.vertices.size() * sizeof(StoredVertex) +
                                        store.vertices.size() * store.attributes.kinds().bytes() +
                                        store.faces.size() * sizeof(LocalFace)))),
      origin_(store.origin) {
    mesh_.vertices.resize(store.vertices.size());
    store.vertices.read(0, mesh_.vertices);
    store.attributes.read(0, mesh_.vertices.size(), mesh_.attributes);
    mesh_.faces.reserve(store.faces.size());
    ooc::SpoolReader<Face> faces(store.faces);
    while (const Face* face = faces.next()) mesh_.faces.push_back(local_face(mesh_, *face));
}

MeshStore WholeMesh::store() const {
    MeshStore store = make_mesh_store(context_, origin_, mesh_.attributes.kinds());
    append_core(store, sort_core(mesh_));
    return store;
}

void WholeMesh::drop_components(const CollapseTarget& target, FinishReport& report) {
    const std::vector<std::uint32_t> label = component_labels(mesh_.vertices.size(), mesh_.faces);
    struct Component {
        double size_sq = 0;
        std::uint32_t label = 0;
        std::uint64_t n_triangles = 0;
        std::uint64_t n_vertices = 0;
        std::uint32_t n_cells = 0;
        std::array<float, 6> box{};
    };
    std::vector<Component> components;
    std::vector<std::uint32_t> index(label.size(), kNoIndex);
    for (std::uint32_t v = 0; v < label.size(); ++v) {
        const std::array<float, 6>& box = mesh_.vertices[v].vertex.box;
        std::uint32_t& at = index[label[v]];
        if (at == kNoIndex) {
            at = static_cast<std::uint32_t>(components.size());
            components.push_back({0, label[v], 0, 0, 0, box});
        }
        Component& c = components[at];
        ++c.n_vertices;
        c.n_cells += mesh_.vertices[v].n_cells;
        widen(c.box, box);
    }
    for (const LocalFace& t : mesh_.faces) ++components[index[label[t[0]]]].n_triangles;
    for (Component& c : components) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = static_cast<double>(c.box[3 + k]) - static_cast<double>(c.box[k]);
            c.size_sq += d * d;
        }
    }
    std::sort(components.begin(), components.end(), [](const Component& a, const Component& b) {
        return a.size_sq != b.size_sq ? a.size_sq < b.size_sq : a.label < b.label;
    });
    std::uint64_t n_triangles = mesh_.faces.size();
    std::uint64_t n_vertices = mesh_.vertices.size();
    std::vector<bool> is_dropped(label.size());
    std::vector<LostPart> lost;
    for (std::size_t i = 0; i + 1 < components.size() && (n_triangles > target.most_triangles ||
                                                          n_vertices > target.most_vertices);
         ++i) {
        is_dropped[components[i].label] = true;
        lost.push_back({components[i].box, components[i].n_cells, 0});
        report.lost_cells += components[i].n_cells;
        n_triangles -= components[i].n_triangles;
        n_vertices -= components[i].n_vertices;
    }
    append_lost(context_, lost, report.lost);
    std::vector<bool> is_kept(label.size());
    for (std::uint32_t v = 0; v < label.size(); ++v) is_kept[v] = !is_dropped[label[v]];
    std::erase_if(mesh_.faces, [&](const LocalFace& t) { return !is_kept[t[0]]; });
    keep_vertices(mesh_, is_kept);
}

bool WholeMesh::merge_regardless(const CollapseTarget& target, bool is_closed,
                                 FinishReport& report) {
    // An inner edge takes two triangles with it.
    const std::uint64_t n_missing =
        std::max((excess(mesh_.faces.size(), target.most_triangles) + 1) / 2,
                 excess(mesh_.vertices.size(), target.most_vertices));
    const std::vector<std::uint32_t> partner =
        pair_vertices(mesh_, std::max<std::uint64_t>(1, n_missing / 2));
    BlockMesh merged = mesh_;
    std::vector<bool> is_kept(merged.vertices.size(), true);
    std::vector<std::pair<VertexId, VertexId>> gone;
    for (std::uint32_t u = 0; u < partner.size(); ++u) {
        StoredVertex& kept = merged.vertices[u];
        kept.flags = VertexFlags::kRaw;
        const std::uint32_t v = partner[u];
        if (v == kNoIndex || v < u) continue;
        const StoredVertex& other = merged.vertices[v];
        const EdgeQuadric edge(kept.vertex, other.vertex);
        kept.vertex.position = edge.optimum;
        kept.vertex.quadric += other.vertex.quadric;
        widen(kept.vertex.box, other.vertex.box);
        kept.n_cells += other.n_cells;
        merged.attributes.merge(u, v);
        is_kept[v] = false;
        gone.emplace_back(other.id, kept.id);
    }
    for (LocalFace& t : merged.faces) {
        for (std::uint32_t& v : t) {
            if (partner[v] != kNoIndex && partner[v] < v) v = partner[v];
        }
    }
    keep_vertices(merged, is_kept);
    const ManifoldCounts counts = make_manifold(merged, {is_closed, false}, &next_fan_);
    if (merged.faces.empty()) return false;
    mesh_ = std::move(merged);
    report.merges.insert(report.merges.end(), gone.begin(), gone.end());
    report.lost_cells += counts.lost_cells;
    append_lost(context_, counts.lost, report.lost);
    return true;
}

}  // namespace hewer::rsimp
