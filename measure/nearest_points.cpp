// SPDX-License-Identifier: MIT
#include "hewer/nearest_points.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "measure/census.h"
#include "measure/lattice.h"
#include "measure/limits.h"
#include "measure/points.h"
#include "ooc/context.h"
#include "ooc/triangle_foot.h"
#include "ooc/vec3.h"
#include "streaming/dereference.h"

namespace hewer {

namespace {

using namespace measuring;

// Triangles that are looked at together: few enough to be near each other.
constexpr std::size_t kGroup = 64;

/// Steps.
struct Nearest {
    double squared_distance = 0;
    Vec3 point{};
    bool is_found = false;

    void add(double squared, const Vec3& foot) {
        // Of several the least: the order in which triangles come does not show.
        if (is_found ? std::tie(squared, foot) >= std::tie(squared_distance, point)
                     : squared > squared_distance) {
            return;
        }
        *this = {squared, foot, true};
    }
};

/// One thread's view of the triangles that pass.
class Search {
  public:
    Search(std::span<const Vec3> points, double most_distance)
        : points_(points), nearest_(points.size(), {most_distance * most_distance, {}, false}) {}

    void meet(std::span<const LatticeTriangle> triangles) {
        Bounds box;
        for (const LatticeTriangle& t : triangles) {
            for (const LatticePoint& p : t) box.extend(to_double(p));
        }
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (squared_distance(box, points_[i]) > nearest_[i].squared_distance) continue;
            for (const LatticeTriangle& t : triangles) meet(i, t);
        }
    }
    [[nodiscard]] const Nearest& nearest(std::size_t i) const { return nearest_[i]; }

  private:
    void meet(std::size_t i, const LatticeTriangle& t) {
        const std::array<Vec3, 3> corners{to_double(t[0]), to_double(t[1]), to_double(t[2])};
        const TriangleFoot foot = foot_of(points_[i], corners[0], corners[1], corners[2]);
        const Vec3 at = foot.weights[0] * corners[0] + foot.weights[1] * corners[1] +
                        foot.weights[2] * corners[2];
        const Vec3 way = points_[i] - at;
        nearest_[i].add(dot(way, way), at);
    }

    std::span<const Vec3> points_;
    std::vector<Nearest> nearest_;
};

}  // namespace

std::vector<std::optional<Vec3>> nearest_points(MeshSource& surface, std::span<const Vec3> points,
                                                double most_distance, const MeasureOptions& options,
                                                const Hooks& hooks) {
    std::vector<std::optional<Vec3>> found(points.size());
    if (points.empty()) return found;
    ooc::Context context(limits_of(options), hooks, {{"scan", 1}, {"nearest", 2}});
    const ooc::HeldInput held = context.hold(surface);
    const std::uint64_t window_bytes = std::min(kMostWindowBytes, context.budget().available() / 4);
    context.begin_stage("scan", surface.info().n_faces, "faces");
    const Census census = take_census_of_surface(context, surface, window_bytes);
    context.end_stage();
    Bounds box = census.bounds;
    for (const Vec3& p : points) box.extend(p);
    const Lattice lattice(box);
    std::vector<Vec3> in_steps;
    in_steps.reserve(points.size());
    for (const Vec3& p : points) in_steps.push_back(to_double(lattice.from_model(p)));

    std::vector<Search> searches(context.n_threads(),
                                 Search(in_steps, most_distance / lattice.step()));
    context.begin_stage("nearest", surface.info().n_faces, "faces");
    streaming::Dereference<LatticeEncoder> triangles(context, surface, {lattice}, window_bytes,
                                                     census.coherence);
    triangles.for_batches(
        [] {},
        [&](unsigned worker, std::span<const LatticeTriangle> batch, std::span<const Triangle>) {
            for (std::size_t first = 0; first < batch.size(); first += kGroup) {
                searches[worker].meet(batch.subspan(first, std::min(kGroup, batch.size() - first)));
            }
        });
    context.end_stage();
    for (std::size_t i = 0; i < points.size(); ++i) {
        Nearest nearest = searches.front().nearest(i);
        for (const Search& search : searches) {
            const Nearest& other = search.nearest(i);
            if (other.is_found) nearest.add(other.squared_distance, other.point);
        }
        if (nearest.is_found) found[i] = lattice.to_model(nearest.point);
    }
    return found;
}

}  // namespace hewer
