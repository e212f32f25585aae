// SPDX-License-Identifier: MIT
#include "tests/bench/openmesh_judge.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <vector>

namespace bench {

OpenMeshVerdict judge_with_openmesh(const PlainMesh& mesh) {
    using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;
    HalfEdgeMesh half_edges;
    std::vector<HalfEdgeMesh::VertexHandle> vertices;
    vertices.reserve(mesh.positions.size() / 3);
    for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
        vertices.push_back(half_edges.add_vertex(
            {mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]}));
    }

    omerr().disable();  // it writes a line for every face that it refuses
    OpenMeshVerdict verdict;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const std::uint32_t a = mesh.indices[t];
        const std::uint32_t b = mesh.indices[t + 1];
        const std::uint32_t c = mesh.indices[t + 2];
        // Its precondition is three different vertices.
        const bool is_taken = a != b && b != c && c != a &&
                              half_edges.add_face(vertices[a], vertices[b], vertices[c]).is_valid();
        if (!is_taken) ++verdict.refused_faces;
    }
    for (const auto edge : half_edges.edges()) {
        if (half_edges.is_boundary(edge)) ++verdict.border_edges;
    }
    for (const auto vertex : half_edges.vertices()) {
        if (!half_edges.is_isolated(vertex) && !half_edges.is_manifold(vertex)) {
            ++verdict.nonmanifold_vertices;
        }
    }
    return verdict;
}

}  // namespace bench
