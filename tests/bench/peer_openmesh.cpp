// SPDX-License-Identifier: MIT
/// OpenMesh's decimater with its quadric module as a whole program, options as OpenMesh sets them.
///
///     peer_openmesh IN.ply OUT.ply TARGET_TRIANGLES
///
/// Its half-edge mesh has no place for edges of more than two faces: faces that it refuses are left
/// out, and their number is printed.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "tests/bench/plain_ply.h"

namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

/// Number of faces that `to` refused.
std::size_t fill(Mesh& to, const bench::PlainMesh& from) {
    std::vector<Mesh::VertexHandle> vertices;
    vertices.reserve(from.positions.size() / 3);
    for (std::size_t i = 0; i < from.positions.size(); i += 3) {
        vertices.push_back(
            to.add_vertex({from.positions[i], from.positions[i + 1], from.positions[i + 2]}));
    }
    omerr().disable();  // it writes a line for every face that it refuses
    std::size_t n_refused = 0;
    for (std::size_t t = 0; t < from.indices.size(); t += 3) {
        const auto face = to.add_face(vertices[from.indices[t]], vertices[from.indices[t + 1]],
                                      vertices[from.indices[t + 2]]);
        if (!face.is_valid()) ++n_refused;
    }
    return n_refused;
}

void decimate(Mesh& mesh, std::size_t target) {
    using Decimater = OpenMesh::Decimater::DecimaterT<Mesh>;
    OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    Decimater decimater(mesh);
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();  // the priority, not a limit
    decimater.initialize();
    decimater.decimate_to_faces(0, target);
    mesh.garbage_collection();
}

bench::PlainMesh plain(const Mesh& mesh) {
    bench::PlainMesh result;
    for (const auto vertex : mesh.vertices()) {
        const auto& p = mesh.point(vertex);
        result.positions.insert(result.positions.end(), {p[0], p[1], p[2]});
    }
    for (const auto face : mesh.faces()) {
        for (const auto vertex : mesh.fv_range(face)) {
            result.indices.push_back(static_cast<std::uint32_t>(vertex.idx()));
        }
    }
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t target = argc == 4 ? std::strtoull(argv[3], nullptr, 10) : 0;
    if (target == 0) {
        std::fputs("usage: peer_openmesh IN.ply OUT.ply TARGET_TRIANGLES\n", stderr);
        return 2;
    }
    try {
        Mesh mesh;
        const std::size_t n_refused = fill(mesh, bench::read_plain_ply(argv[1]));
        decimate(mesh, target);
        bench::write_plain_ply(argv[2], plain(mesh));
        std::printf("{\"refused_faces\": %zu}\n", n_refused);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peer_openmesh: %s\n", error.what());
        return 1;
    }
    return 0;
}
