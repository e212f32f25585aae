// SPDX-License-Identifier: MIT
/// Reads a MeshSource to the end, on several threads, and puts the batches back in order.
#pragma once

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "hewer/mesh_source.h"

namespace hewer::test {

struct ReadBack {
    Mesh mesh;
    std::vector<std::array<Vec3, 3>> soup;
    InputDefects defects;
    std::uint64_t n_faces = 0;
    /// first and size of each batch, vertices before triangles, sorted
    std::vector<std::pair<std::uint64_t, std::uint64_t>> batches;
};

/// Calls pull(batch) on `n_threads` threads until it returns false; the batches by `key(batch)`.
template <typename Batch, typename Pull, typename Key>
std::map<std::uint64_t, Batch> pull_all(unsigned n_threads, const Pull& pull, const Key& key) {
    std::map<std::uint64_t, Batch> batches;
    std::mutex mutex;
    std::exception_ptr error;
    const auto run = [&] {
        try {
            Batch batch;
            while (pull(batch)) {
                const std::lock_guard lock(mutex);
                batches[key(batch)] = batch;
            }
        } catch (...) {
            const std::lock_guard lock(mutex);
            error = std::current_exception();
        }
    };
    std::vector<std::thread> threads;
    for (unsigned i = 1; i < n_threads; ++i) threads.emplace_back(run);
    run();
    for (std::thread& thread : threads) thread.join();
    if (error) std::rethrow_exception(error);
    return batches;
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

inline void read_vertices(MeshSource& source, ReadBack& result, unsigned n_threads = 1) {
    source.begin_vertices();
    const auto batches = pull_all<VertexBatch>(
        n_threads, [&](VertexBatch& b) { return source.next_vertices(b); },
        [](const VertexBatch& b) { return b.first; });
    for (const auto& [first, batch] : batches) {
        result.batches.emplace_back(first, batch.positions.size());
        append(result.mesh.positions, batch.positions);
        append(result.mesh.normals, batch.normals);
        append(result.mesh.colors, batch.colors);
        result.defects.merge(batch.defects);
    }
}

inline void read_triangles(MeshSource& source, ReadBack& result, unsigned n_threads = 1) {
    source.begin_triangles();
    const auto batches = pull_all<TriangleBatch>(
        n_threads, [&](TriangleBatch& b) { return source.next_triangles(b); },
        [](const TriangleBatch& b) { return b.first_face; });
    for (const auto& [first, batch] : batches) {
        result.batches.emplace_back(first, batch.n_faces);
        result.n_faces += batch.n_faces;
        append(result.mesh.triangles, batch.corners);
        append(result.soup, batch.points);
        result.defects.merge(batch.defects);
    }
}

inline ReadBack read_all(MeshSource& source, unsigned n_threads = 1) {
    ReadBack result;
    read_vertices(source, result, n_threads);
    read_triangles(source, result, n_threads);
    return result;
}

}  // namespace hewer::test
