// SPDX-License-Identifier: MIT
#include "rsimp/collapse_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "rsimp/face_components.h"

namespace hewer::rsimp {

namespace {

/// Takes the components of the given vertices out of the mesh.
std::vector<LostPart> take_out(BlockMesh& mesh, const std::vector<std::uint32_t>& vertices,
                               std::vector<bool>& is_kept) {
    const std::vector<std::uint32_t> label = component_labels(mesh.vertices.size(), mesh.faces);
    std::vector<LostPart> lost;
    std::vector<std::uint32_t> part(mesh.vertices.size(), kNoIndex);
    for (const std::uint32_t v : vertices) {
        part[label[v]] = static_cast<std::uint32_t>(lost.size());
        lost.push_back({mesh.vertices[v].vertex.box, 0, 0});
    }
    for (std::uint32_t v = 0; v < label.size(); ++v) {
        const std::uint32_t p = part[label[v]];
        if (!is_kept[v] || p == kNoIndex) continue;
        is_kept[v] = false;
        lost[p].n_cells += mesh.vertices[v].n_cells;
        widen(lost[p].box, mesh.vertices[v].vertex.box);
    }
    std::erase_if(mesh.faces, [&](const LocalFace& t) { return !is_kept[t[0]]; });
    return lost;
}

}  // namespace

std::vector<LostPart> apply_steps(BlockMesh& mesh, std::span<const CollapseStep> steps,
                                  std::vector<std::pair<VertexId, VertexId>>* merges) {
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0U);
    std::vector<bool> is_kept(mesh.vertices.size(), true);
    std::vector<std::uint32_t> vanished;
    for (const CollapseStep& step : steps) {
        if (step.kept == kNoIndex) {
            vanished.push_back(step.gone);
            continue;
        }
        StoredVertex& kept = mesh.vertices[step.kept];
        const StoredVertex& gone = mesh.vertices[step.gone];
        kept.vertex.position = step.position;
        kept.vertex.quadric += gone.vertex.quadric;
        widen(kept.vertex.box, gone.vertex.box);
        kept.n_cells += gone.n_cells;
        mesh.attributes.merge(step.kept, step.gone);
        parent[step.gone] = step.kept;
        is_kept[step.gone] = false;
        if (merges != nullptr) merges->emplace_back(gone.id, kept.id);
    }
    if (steps.empty()) return {};
    const auto find = [&](std::uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (LocalFace& t : mesh.faces) {
        for (std::uint32_t& v : t) v = find(v);
    }
    std::erase_if(mesh.faces, is_degenerate);
    std::vector<LostPart> lost;
    if (!vanished.empty()) lost = take_out(mesh, vanished, is_kept);
    keep_vertices(mesh, is_kept);
    return lost;
}

CoreAndRim split_rim(BlockMesh mesh) {
    constexpr auto kFar = std::numeric_limits<std::uint8_t>::max();
    const std::size_t n = mesh.vertices.size();
    // Rings around the frozen vertices; a vertex of ring kRimRings is the first that may be cut at.
    std::vector<std::uint8_t> ring(n, kFar);
    bool has_rim = false;
    for (std::size_t v = 0; v < n; ++v) {
        if ((mesh.vertices[v].flags & VertexFlags::kFrozen) == 0) continue;
        ring[v] = 0;
        has_rim = true;
    }
    CoreAndRim parts;
    if (!has_rim) {
        parts.core = std::move(mesh);
    } else {
        for (std::uint8_t r = 0; r < CoreAndRim::kRimRings; ++r) {
            for (const LocalFace& t : mesh.faces) {
                if (std::min({ring[t[0]], ring[t[1]], ring[t[2]]}) != r) continue;
                for (const std::uint32_t v : t) {
                    ring[v] = std::min<std::uint8_t>(ring[v], static_cast<std::uint8_t>(r + 1));
                }
            }
        }
        const auto is_rim = [&](const LocalFace& t) {
            return std::min({ring[t[0]], ring[t[1]], ring[t[2]]}) < CoreAndRim::kRimRings;
        };
        for (const LocalFace& t : mesh.faces) {
            (is_rim(t) ? parts.rim : parts.core).faces.push_back(t);
        }
        std::vector<bool> in_core(n);
        std::vector<bool> in_rim(n);
        for (std::size_t v = 0; v < n; ++v) {
            in_core[v] = ring[v] >= CoreAndRim::kRimRings;
            in_rim[v] = ring[v] <= CoreAndRim::kRimRings;
        }
        parts.core.vertices = mesh.vertices;
        parts.core.attributes = mesh.attributes;
        keep_vertices(parts.core, in_core);
        for (std::size_t v = 0; v < n; ++v) {
            std::uint32_t& flags = mesh.vertices[v].flags;
            flags |= VertexFlags::is_free(flags) ? VertexFlags::kProcessed : 0;
            flags &= ~VertexFlags::kFrozen;
            if (in_core[v]) flags |= VertexFlags::kLocked;
        }
        parts.rim.vertices = std::move(mesh.vertices);
        parts.rim.attributes = std::move(mesh.attributes);
        keep_vertices(parts.rim, in_rim);
    }
    // Locked ones have been written by the block that finished their other faces, but the core's
    // faces may use them.
    return parts;
}

}  // namespace hewer::rsimp
