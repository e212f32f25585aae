// SPDX-License-Identifier: MIT
#include "rsimp/topology_change.h"

#include <algorithm>
#include <vector>

#include "rsimp/start_mesh.h"

namespace hewer::rsimp {

MergedMesh merge_regardless(ooc::Context& context, const EdgeCollapse& collapse,
                            std::uint64_t n_merges, bool is_closed) {
    struct Candidate {
        double cost;
        std::uint32_t u;
        std::uint32_t v;
    };
    const CollapseMesh& old = collapse.mesh();
    const std::uint64_t n_old = old.vertices.size();
    std::vector<Candidate> candidates;
    for (std::uint64_t t = 0; t < old.triangles.size(); ++t) {
        if (!collapse.is_live_triangle(t)) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [u, v] = std::minmax(old.triangles[t][i], old.triangles[t][(i + 1) % 3]);
            candidates.push_back({merge(old.vertices[u], old.vertices[v]).cost, u, v});
        }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        if (a.cost != b.cost) return a.cost < b.cost;
        return a.u != b.u ? a.u < b.u : a.v < b.v;
    });
    std::vector<std::uint32_t> partner(n_old, kNoIndex);
    for (const Candidate& c : candidates) {
        if (n_merges == 0) break;
        if (partner[c.u] != kNoIndex || partner[c.v] != kNoIndex) continue;
        partner[c.u] = c.v;
        partner[c.v] = c.u;
        --n_merges;
    }

    MergedMesh merged;
    merged.class_of_old_vertex = {context.budget(), "merged vertices", n_old};
    std::fill(merged.class_of_old_vertex.begin(), merged.class_of_old_vertex.end(), kNoIndex);
    std::uint32_t n = 0;
    for (std::uint32_t v = 0; v < n_old; ++v) {
        if (!collapse.is_live(v)) continue;
        const bool is_second = partner[v] != kNoIndex && partner[v] < v;
        merged.class_of_old_vertex[v] = is_second ? merged.class_of_old_vertex[partner[v]] : n++;
    }
    merged.n_classes = n;
    Clusters classes;
    classes.n_clusters = n;
    classes.positions = {context.budget(), "merged vertices", n};
    classes.quadrics = {context.budget(), "merged vertices", n};
    classes.boxes = {context.budget(), "merged vertices", n};
    if (!old.attributes.empty()) classes.attributes = {context.budget(), "merged attributes", n};
    for (std::uint32_t v = 0; v < n_old; ++v) {
        if (!collapse.is_live(v)) continue;
        const std::uint32_t c = merged.class_of_old_vertex[v];
        if (!old.attributes.empty()) classes.attributes[c] += old.attributes[v];
        if (partner[v] != kNoIndex && partner[v] < v) continue;
        const CollapseVertex vertex = partner[v] == kNoIndex
                                          ? old.vertices[v]
                                          : merge(old.vertices[v], old.vertices[partner[v]]).vertex;
        classes.positions[c] = vertex.position;
        classes.quadrics[c] = vertex.quadric;
        classes.boxes[c] = vertex.box;
    }
    ooc::Array<CellTriple> triples(context.budget(), "merged triangles", collapse.n_triangles());
    std::uint64_t at = 0;
    for (std::uint64_t t = 0; t < old.triangles.size(); ++t) {
        if (!collapse.is_live_triangle(t)) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            triples[at][i] = merged.class_of_old_vertex[old.triangles[t][i]];
        }
        ++at;
    }
    // Vertices that had collapsed go where their representative goes.
    for (std::uint32_t v = 0; v < n_old; ++v) {
        const std::uint32_t now = collapse.representative(v);
        if (now != kNoIndex) merged.class_of_old_vertex[v] = merged.class_of_old_vertex[now];
    }
    ManifoldMesh manifold =
        build_manifold(context, triples.span(), classes.positions.span(), is_closed);
    merged.class_of_vertex = {context.budget(), "merged vertices",
                              manifold.cluster_of_vertex.size()};
    std::copy(manifold.cluster_of_vertex.begin(), manifold.cluster_of_vertex.end(),
              merged.class_of_vertex.begin());
    merged.mesh = make_collapse_mesh(context, classes, manifold);
    return merged;
}

}  // namespace hewer::rsimp
