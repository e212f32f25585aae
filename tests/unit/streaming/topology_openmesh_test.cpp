// SPDX-License-Identifier: MIT
/// The counter against OpenMesh's half-edges, which know nothing of vertices' links or sorting.
#include <gtest/gtest.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <set>
#include <vector>

#include "ooc/context.h"
#include "streaming/topology_scan.h"
#include "tests/support/shapes.h"

namespace hewer::streaming {

namespace {

using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<>;

struct Verdict {
    TopologyReport topology;
    std::vector<Triangle> taken;  // half-edges hold no edge of three faces
};

Verdict ask_openmesh(const Mesh& mesh) {
    HalfEdges half_edges;
    std::vector<HalfEdges::VertexHandle> vertices;
    for (const Vec3& p : mesh.positions) {
        vertices.push_back(half_edges.add_vertex(
            {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}));
    }
    omerr().disable();
    Verdict verdict;
    for (const Triangle& t : mesh.triangles) {
        if (half_edges.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]).is_valid()) {
            verdict.taken.push_back(t);
        }
    }
    TopologyReport& r = verdict.topology;
    std::int64_t n_edges = 0;
    for (const auto edge : half_edges.edges()) {
        ++n_edges;
        if (half_edges.is_boundary(edge)) ++r.border_edges;
    }
    std::int64_t n_vertices = 0;
    std::set<int> unseen;
    for (const auto vertex : half_edges.vertices()) {
        if (half_edges.is_isolated(vertex)) continue;
        ++n_vertices;
        unseen.insert(vertex.idx());
        if (!half_edges.is_manifold(vertex)) ++r.nonmanifold_vertices;
    }
    r.euler = n_vertices - n_edges + static_cast<std::int64_t>(verdict.taken.size());
    std::set<int> walked;
    for (const auto start : half_edges.halfedges()) {
        if (!half_edges.is_boundary(start) || !walked.insert(start.idx()).second) continue;
        ++r.border_loops;
        for (auto h = half_edges.next_halfedge_handle(start); h != start;
             h = half_edges.next_halfedge_handle(h)) {
            walked.insert(h.idx());
        }
    }
    while (!unseen.empty()) {
        ++r.components;
        std::vector<int> reached{*unseen.begin()};
        unseen.erase(unseen.begin());
        while (!reached.empty()) {
            const HalfEdges::VertexHandle v(reached.back());
            reached.pop_back();
            for (auto it = half_edges.vv_begin(v); it != half_edges.vv_end(v); ++it) {
                if (unseen.erase(it->idx()) != 0) reached.push_back(it->idx());
            }
        }
    }
    return verdict;
}

/// Spheres, tori and sheets, some of their faces torn out.
Mesh torn(std::uint64_t seed) {
    test::Random random(seed);
    Mesh mesh;
    const std::uint64_t n_parts = 1 + random.below(5);
    for (std::uint64_t i = 0; i < n_parts; ++i) {
        const std::uint64_t kind = random.below(3);
        const std::uint64_t n = 4 + random.below(8);
        Mesh part = kind == 0 ? test::cube_sphere(n) : test::torus(2 * n, n);
        if (kind == 2) part = test::plane_grid(n);
        mesh = test::joined(mesh, part);
    }
    // Few holes stay apart; many touch in vertices.
    const double share = seed % 2 == 0 ? 0.004 : random.between(0, 0.25);
    std::erase_if(mesh.triangles, [&](const Triangle&) { return random.unit() < share; });
    return test::shuffled(mesh, seed);
}

}  // namespace

TEST(TopologyScan, AgreesWithHalfEdges) {
    std::size_t n_clean = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Mesh mesh = torn(seed);
        // Half-edges cannot be built where fans touch in every order; what was taken is the mesh.
        const Verdict verdict = ask_openmesh(mesh);
        mesh.triangles = verdict.taken;
        ooc::Context context(
            ooc::ResourceLimits{.memory_bytes = std::uint64_t{256} << 20, .n_threads = 2});
        const auto source = view_mesh(mesh);
        const TopologyReport topology = count_topology(context, *source);
        const TopologyReport& expected = verdict.topology;
        EXPECT_EQ(topology.components, expected.components) << seed;
        EXPECT_EQ(topology.border_edges, expected.border_edges) << seed;
        EXPECT_EQ(topology.nonmanifold_edges, 0U) << seed;
        EXPECT_EQ(topology.nonmanifold_vertices, expected.nonmanifold_vertices) << seed;
        EXPECT_EQ(topology.euler, expected.euler) << seed;
        if (expected.nonmanifold_vertices == 0) {
            ++n_clean;
            EXPECT_EQ(topology.border_loops, expected.border_loops) << seed;
        } else {
            EXPECT_LE(topology.border_loops, expected.border_loops) << seed;
        }
    }
    EXPECT_GE(n_clean, 20U) << "too few meshes tell about loops";
}

}  // namespace hewer::streaming
