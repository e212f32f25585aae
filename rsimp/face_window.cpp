// SPDX-License-Identifier: MIT
#include "rsimp/face_window.h"

#include <algorithm>

namespace hewer::rsimp {

namespace {

// Vertices this many times the number of faces above the smallest one are found by address; the
// rest, a few per cent where the Morton curve jumps, by searching.
constexpr std::uint64_t kNear = 4;

// Records between two wanted ones are read along up to this many; more would cost more than the
// next call.
constexpr std::uint64_t kMostSkipped = 8;
constexpr std::uint64_t kMostRead = 512;

}  // namespace

FaceWindow load_window(const MeshStore& mesh, const IdIndex& index, std::uint64_t first,
                       std::uint64_t last) {
    FaceWindow window;
    window.next = last < mesh.faces.size() ? index.rank(mesh.faces.at(last)[0]) : index.size();
    std::vector<Face> corners(last - first);
    mesh.faces.read(first, corners);
    if (corners.empty()) return window;
    for (Face& f : corners) {
        for (std::uint64_t& corner : f) corner = index.rank(corner);
    }
    const std::uint64_t base = corners[0][0];  // faces rise, and begin with their smallest vertex
    const std::uint64_t n_near = std::min(kNear * corners.size(), index.size() - base);
    std::vector<std::uint32_t> place(n_near);
    std::vector<std::uint64_t> far;
    for (const Face& f : corners) {
        for (const std::uint64_t v : f) {
            if (v - base < n_near) {
                place[v - base] = 1;
            } else {
                far.push_back(v);
            }
        }
    }
    for (std::uint64_t i = 0; i < n_near; ++i) {
        if (place[i] == 0) continue;
        place[i] = static_cast<std::uint32_t>(window.vertices.size());
        window.vertices.push_back(base + i);
    }
    std::sort(far.begin(), far.end());
    far.erase(std::unique(far.begin(), far.end()), far.end());
    const std::size_t n_found = window.vertices.size();
    window.vertices.insert(window.vertices.end(), far.begin(), far.end());
    window.faces.reserve(corners.size());
    for (const Face& f : corners) {
        auto& face = window.faces.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            face[i] = f[i] - base < n_near
                          ? place[f[i] - base]
                          : static_cast<std::uint32_t>(
                                n_found +
                                static_cast<std::size_t>(
                                    std::lower_bound(far.begin(), far.end(), f[i]) - far.begin()));
        }
    }
    return window;
}

std::vector<Vec3> read_positions(const MeshStore& mesh, std::span<const std::uint64_t> vertices) {
    std::vector<Vec3> positions;
    positions.reserve(vertices.size());
    std::vector<StoredVertex> records;
    for (std::size_t i = 0; i < vertices.size();) {
        std::size_t j = i + 1;
        while (j < vertices.size() && vertices[j] - vertices[j - 1] <= kMostSkipped &&
               vertices[j] - vertices[i] < kMostRead) {
            ++j;
        }
        records.resize(vertices[j - 1] - vertices[i] + 1);
        mesh.vertices.read(vertices[i], records);
        for (std::size_t k = i; k < j; ++k) {
            positions.push_back(records[vertices[k] - vertices[i]].vertex.position);
        }
        i = j;
    }
    return positions;
}

}  // namespace hewer::rsimp
