// SPDX-License-Identifier: MIT
#include "hewer/surface_part.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

#include "measure/limits.h"
#include "measure/points.h"
#include "ooc/context.h"
#include "streaming/dereference.h"

namespace hewer {

namespace {

using namespace measuring;
using Corners = std::array<Vec3, 3>;

// Triangles that are looked at together: few enough to be near each other.
constexpr std::size_t kGroup = 64;
// Of a triangle: its corners, twice, and itself.
constexpr std::uint64_t kBytes = 2 * sizeof(Corners) + sizeof(Triangle);

bool touch(const Bounds& a, const Bounds& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(a.min[k] <= b.max[k] && b.min[k] <= a.max[k])) return false;
    }
    return true;
}

Bounds box_of(std::span<const Corners> triangles) {
    Bounds box;
    for (const Corners& t : triangles) {
        for (const Vec3& p : t) box.extend(p);
    }
    return box;
}

/// Those of `group` that touch any of `boxes` are added to `found`.
void add_touching(std::span<const Corners> group, std::span<const Bounds> boxes,
                  std::vector<Corners>& found) {
    const Bounds all = box_of(group);
    std::vector<Bounds> near;
    std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(near),
                 [&](const Bounds& box) { return touch(box, all); });
    if (near.empty()) return;
    for (const Corners& t : group) {
        const Bounds own = box_of({&t, 1});
        if (std::any_of(near.begin(), near.end(),
                        [&](const Bounds& box) { return touch(box, own); })) {
            found.push_back(t);
        }
    }
}

}  // namespace

std::optional<Mesh> part_of_surface(MeshSource& surface, std::span<const Bounds> boxes,
                                    std::uint64_t most_triangles, const MeasureOptions& options,
                                    const Hooks& hooks) {
    ooc::Context context(limits_of(options), hooks, {{"look", 1}});
    const ooc::HeldInput held = context.hold(surface);
    std::vector<std::vector<Corners>> found(context.n_threads());
    std::vector<std::vector<ooc::Reservation>> bytes(context.n_threads());
    std::atomic<std::uint64_t> n_found{0};
    context.begin_stage("look", surface.info().n_faces, "faces");
    streaming::Dereference<ModelEncoder> triangles(
        context, surface, {}, std::min(kMostWindowBytes, context.budget().available() / 2));
    triangles.for_batches(
        [&] {
            for (auto& part : found) part.clear();
            for (auto& part : bytes) part.clear();
            n_found = 0;
        },
        [&](unsigned worker, std::span<const Corners> batch, std::span<const Triangle>) {
            if (n_found > most_triangles) return;
            const std::size_t before = found[worker].size();
            for (std::size_t first = 0; first < batch.size(); first += kGroup) {
                add_touching(batch.subspan(first, std::min(kGroup, batch.size() - first)), boxes,
                             found[worker]);
            }
            const std::uint64_t n = found[worker].size() - before;
            if (n == 0) return;
            bytes[worker].push_back(context.budget().reserve("part of a surface", n * kBytes));
            n_found += n;
        });
    context.end_stage();
    if (n_found > most_triangles) return {};

    std::vector<Corners> all;
    all.reserve(n_found);
    for (auto& part : found) {
        all.insert(all.end(), part.begin(), part.end());
        part = {};
    }
    std::sort(all.begin(), all.end());
    Mesh mesh;
    mesh.positions.reserve(3 * all.size());
    mesh.triangles.reserve(all.size());
    for (const Corners& t : all) {
        const std::uint64_t first = mesh.positions.size();
        mesh.positions.insert(mesh.positions.end(), t.begin(), t.end());
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

}  // namespace hewer
