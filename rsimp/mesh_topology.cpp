// SPDX-License-Identifier: MIT
#include "rsimp/mesh_topology.h"

#include <algorithm>

#include "ooc/parallel.h"
#include "rsimp/face_window.h"
#include "rsimp/id_index.h"
#include "streaming/topology_counter.h"

namespace hewer::rsimp {

TopologyReport count_topology(ooc::Context& context, const MeshStore& mesh) {
    constexpr std::uint64_t kWindowFaces = 1 << 15;
    const std::uint64_t n_vertices = mesh.vertices.size();
    const std::uint64_t n_faces = mesh.faces.size();
    if (n_faces == 0) return {};
    const std::uint64_t n_at_work = std::uint64_t{context.n_threads()} + 1;
    const ooc::Reservation windows = context.budget().reserve(
        "windows of a mesh", n_at_work * kWindowFaceBytes * std::min(kWindowFaces, n_faces));
    IdIndex index(context, mesh.vertices.at(0).id, mesh.vertices.at(n_vertices - 1).id);
    ooc::SpoolReader<StoredVertex> vertices(mesh.vertices);
    while (const StoredVertex* v = vertices.next()) index.append(v->id);
    streaming::TopologyCounter counter(context, n_vertices, context.sort_bytes());
    struct Window {
        FaceWindow faces;
        streaming::WindowTopology topology;
    };
    context.workers().in_order(
        (n_faces + kWindowFaces - 1) / kWindowFaces, n_at_work,
        [&](std::uint64_t w) {
            const std::uint64_t first = w * kWindowFaces;
            Window window{load_window(mesh, index, first, std::min(first + kWindowFaces, n_faces)),
                          {}};
            window.topology = streaming::count_window(window.faces);
            return window;
        },
        [&](std::uint64_t, const Window& window) {
            counter.add(window.faces, window.topology);
            context.check_stop();
        });
    return counter.finish();
}

}  // namespace hewer::rsimp
