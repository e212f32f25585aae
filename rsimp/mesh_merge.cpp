// SPDX-License-Identifier: MIT
#include "rsimp/mesh_merge.h"

#include <algorithm>
#include <utility>

namespace hewer::rsimp {

namespace {

/// Calls take(part) for the records of all parts in rising order of key(record).
template <typename T, typename Key, typename Take>
void merge_sorted(std::vector<ooc::SpoolReader<T>>& readers, const Key& key, const Take& take) {
    for (;;) {
        std::size_t best = readers.size();
        const T* record = nullptr;
        for (std::size_t p = 0; p < readers.size(); ++p) {
            const T* candidate = readers[p].peek();
            if (candidate == nullptr) continue;
            if (record == nullptr || key(*candidate) < key(*record)) {
                best = p;
                record = candidate;
            }
        }
        if (record == nullptr) return;
        take(best, *readers[best].next());
    }
}

}  // namespace

MeshStore make_mesh_store(ooc::Context& context, const Vec3& origin, AttributeKinds attributes) {
    MeshStore store;
    store.origin = origin;
    store.vertices = {context, "finished vertices"};
    store.faces = {context, "finished faces"};
    store.attributes = {context, attributes};
    return store;
}

void append_core(MeshStore& part, BlockMesh core) {
    std::vector<Face> faces;
    faces.reserve(core.faces.size());
    for (const LocalFace& t : core.faces) faces.push_back(global_face(core, t));
    std::sort(faces.begin(), faces.end());
    part.faces.append(faces);
    for (std::size_t v = 0; v < core.vertices.size(); ++v) {
        if ((core.vertices[v].flags & VertexFlags::kLocked) != 0) continue;
        part.vertices.push(core.vertices[v]);
        part.attributes.push(core.attributes, v);
    }
}

MeshStore merge_parts(ooc::Context& context, std::vector<MeshStore> parts) {
    if (parts.size() == 1) return std::move(parts.front());
    AttributeKinds kinds;
    for (const MeshStore& part : parts) {
        kinds.sums |= part.attributes.kinds().sums;
        kinds.quadrics |= part.attributes.kinds().quadrics;
    }
    MeshStore whole = make_mesh_store(context, parts.front().origin, kinds);
    {
        std::vector<ooc::SpoolReader<StoredVertex>> vertices;
        std::vector<ooc::SpoolReader<cluster::CellAttributes>> sums;
        std::vector<ooc::SpoolReader<cluster::AttributeQuadric>> quadrics;
        for (const MeshStore& part : parts) {
            vertices.emplace_back(part.vertices);
            if (kinds.sums) sums.emplace_back(part.attributes.sums);
            if (kinds.quadrics) quadrics.emplace_back(part.attributes.quadrics);
        }
        merge_sorted(
            vertices, [](const StoredVertex& v) { return v.id; },
            [&](std::size_t part, const StoredVertex& v) {
                whole.vertices.push(v);
                if (kinds.sums) whole.attributes.sums.push(*sums[part].next());
                if (kinds.quadrics) whole.attributes.quadrics.push(*quadrics[part].next());
            });
    }
    for (MeshStore& part : parts) {
        part.vertices.release();
        part.attributes.release();
    }
    std::vector<ooc::SpoolReader<Face>> faces;
    faces.reserve(parts.size());
    for (const MeshStore& part : parts) faces.emplace_back(part.faces);
    merge_sorted(
        faces, [](const Face& f) { return f; },
        [&](std::size_t, const Face& f) { whole.faces.push(f); });
    return whole;
}

}  // namespace hewer::rsimp
