// SPDX-License-Identifier: MIT
#include "rsimp/mesh_merge.h"

#include <algorithm>
#include <span>
#include <utility>

namespace hewer::rsimp {

namespace {

/// Calls take(part, records) for runs of the records of all parts, in rising order of key(record).
template <typename T, typename Key, typename Take>
void merge_sorted(std::vector<ooc::SpoolReader<T>>& readers, const Key& key, const Take& take) {
    for (;;) {
        std::size_t first = readers.size();
        std::size_t second = readers.size();
        for (std::size_t p = 0; p < readers.size(); ++p) {
            const T* const head = readers[p].peek();
            if (head == nullptr) continue;
            if (first == readers.size() || key(*head) < key(*readers[first].peek())) {
                second = std::exchange(first, p);
            } else if (second == readers.size() || key(*head) < key(*readers[second].peek())) {
                second = p;
            }
        }
        if (first == readers.size()) return;
        std::span<const T> run = readers[first].peek_piece();
        if (second != readers.size()) {
            const auto least_of_others = key(*readers[second].peek());
            const auto end = std::partition_point(
                run.begin(), run.end(), [&](const T& r) { return key(r) < least_of_others; });
            run = run.first(static_cast<std::size_t>(end - run.begin()));
        }
        take(first, run);
        readers[first].skip(run.size());
    }
}

template <typename T>
void copy_next(ooc::SpoolReader<T>& reader, std::size_t n, ooc::Spool<T>& spool) {
    while (n > 0) {
        std::span<const T> piece = reader.peek_piece();
        piece = piece.first(std::min(n, piece.size()));
        spool.append(piece);
        reader.skip(piece.size());
        n -= piece.size();
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

SortedCore sort_core(BlockMesh core) {
    SortedCore sorted;
    sorted.faces.reserve(core.faces.size());
    for (const LocalFace& t : core.faces) sorted.faces.push_back(global_face(core, t));
    std::sort(sorted.faces.begin(), sorted.faces.end());
    std::vector<bool> is_added(core.vertices.size());
    for (std::size_t v = 0; v < core.vertices.size(); ++v) {
        is_added[v] = (core.vertices[v].flags & VertexFlags::kLocked) == 0;
    }
    core.faces.clear();
    keep_vertices(core, is_added);
    sorted.vertices = std::move(core.vertices);
    sorted.attributes = std::move(core.attributes);
    return sorted;
}

void append_core(MeshStore& part, const SortedCore& core) {
    part.faces.append(core.faces);
    part.vertices.append(core.vertices);
    part.attributes.append(core.attributes);
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
            [&](std::size_t part, std::span<const StoredVertex> run) {
                whole.vertices.append(run);
                if (kinds.sums) copy_next(sums[part], run.size(), whole.attributes.sums);
                if (kinds.quadrics) {
                    copy_next(quadrics[part], run.size(), whole.attributes.quadrics);
                }
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
        [&](std::size_t, std::span<const Face> run) { whole.faces.append(run); });
    return whole;
}

}  // namespace hewer::rsimp
