// SPDX-License-Identifier: MIT
#include "rsimp/face_normals.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "ooc/external_sort.h"
#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/face_window.h"

namespace hewer::rsimp {

namespace {

/// A bit for each vertex whose normal is not usable; empty if there is none.
ooc::Array<std::uint64_t> find_missing(ooc::Context& context, const MeshStore& mesh) {
    ooc::Array<std::uint64_t> missing(context.budget(), "missing normals",
                                      (mesh.vertices.size() + 63) / 64);
    bool is_any = false;
    std::uint64_t v = 0;
    ooc::SpoolReader<cluster::CellAttributes> attributes(mesh.attributes.sums);
    while (const cluster::CellAttributes* a = attributes.next()) {
        if (!is_usable_normal(a->normal)) {
            missing[v / 64] |= std::uint64_t{1} << (v % 64);
            is_any = true;
        }
        ++v;
    }
    if (!is_any) missing.release();
    return missing;
}

}  // namespace

bool is_usable_normal(const std::array<float, 3>& sum) {
    constexpr float kLeastLengthSquared = 1e-6F;
    return sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] > kLeastLengthSquared;
}

ooc::Spool<FaceNormal> missing_normals(ooc::Context& context, const MeshStore& mesh,
                                       const IdIndex& index, std::uint64_t window_faces) {
    const ooc::Array<std::uint64_t> missing = find_missing(context, mesh);
    if (missing.empty()) return {};
    const auto is_missing = [&](std::uint64_t v) { return (missing[v / 64] >> (v % 64) & 1) != 0; };
    const auto sum_window = [&](std::uint64_t w) {
        const FaceWindow window = load_window(mesh, index, w * window_faces,
                                              std::min((w + 1) * window_faces, mesh.faces.size()));
        std::vector<FaceNormal> sums;
        constexpr std::uint32_t kNone = ~0U;
        std::vector<std::uint32_t> slot(window.vertices.size(), kNone);
        for (std::size_t v = 0; v < slot.size(); ++v) {
            if (!is_missing(window.vertices[v])) continue;
            slot[v] = static_cast<std::uint32_t>(sums.size());
            sums.push_back({window.vertices[v], w, {}});
        }
        if (sums.empty()) return sums;
        const std::vector<Vec3> positions = read_positions(mesh, window.vertices);
        for (const auto& f : window.faces) {
            if (slot[f[0]] == kNone && slot[f[1]] == kNone && slot[f[2]] == kNone) continue;
            const Vec3& p = positions[f[0]];
            const Vec3 normal = cross(positions[f[1]] - p, positions[f[2]] - p);
            for (const std::uint32_t v : f) {
                if (slot[v] != kNone) sums[slot[v]].sum = sums[slot[v]].sum + normal;
            }
        }
        return sums;
    };
    ooc::ExternalSorter<FaceNormal, std::less<>> sorter(context, "missing normals", {},
                                                        context.sort_bytes());
    context.workers().in_order((mesh.faces.size() + window_faces - 1) / window_faces,
                               context.n_threads() + 1, sum_window,
                               [&](std::uint64_t, const std::vector<FaceNormal>& sums) {
                                   sorter.add(sums);
                                   context.check_stop();
                               });
    return sorter.finish();
}

}  // namespace hewer::rsimp
