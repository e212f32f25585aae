// SPDX-License-Identifier: MIT
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>

#include "hewer/error.h"
#include "hewer/within.h"
#include "measure/census.h"
#include "measure/far_places.h"
#include "measure/lattice.h"
#include "measure/limits.h"
#include "measure/piece.h"
#include "measure/piece_limits.h"
#include "measure/piece_search.h"
#include "measure/resident_surface.h"
#include "measure/triangle_index.h"
#include "measure/verdict.h"
#include "ooc/context.h"
#include "ooc/parallel.h"

namespace hewer {

namespace {

using namespace measuring;

// Triangles that a worker looks at before it asks for more.
constexpr std::uint64_t kPerTask = 64;

class PartsProof {
  public:
    PartsProof(double distance, const MeasureOptions& options, const Hooks& hooks)
        : distance_(distance),
          options_(options),
          context_(limits_of(options), hooks, {{"prove", 1}}) {}

    WithinReport run(MeshSource& original_part, MeshSource& simplified, MeshSource& part);

  private:
    struct Surface {
        MeshSource& source;
        ooc::HeldInput held;
        Census census;
    };
    Surface surface_of(MeshSource& source) {
        ooc::HeldInput held = context_.hold(source);
        Census census = take_census_of_surface(context_, source, kMostWindowBytes);
        return {source, std::move(held), std::move(census)};
    }
    ooc::Array<LatticeTriangle> load(const Surface& surface) {
        return load_surface(context_, surface.source, surface.census, lattice_).triangles;
    }
    /// What of some triangles is not near.
    FarPlaces search(std::span<const LatticeTriangle> triangles, const TriangleIndex& to,
                     PieceLimits& limits);
    [[nodiscard]] FarPlaces no_places() {
        return {context_, box_, options_.places_apart * box_.diagonal()};
    }

    double distance_;
    const MeasureOptions& options_;
    ooc::Context context_;
    Lattice lattice_;
    Bounds box_;  // of all, in steps
};

FarPlaces PartsProof::search(std::span<const LatticeTriangle> triangles, const TriangleIndex& to,
                             PieceLimits& limits) {
    FarPlaces far = no_places();
    std::mutex mutex;
    std::atomic<std::uint64_t> next{0};
    context_.workers().on_each([&](unsigned) {
        PieceSearch search(to, limits, no_places());
        for (;;) {
            const std::uint64_t first = next.fetch_add(kPerTask);
            if (first >= triangles.size()) break;
            for (const LatticeTriangle& t :
                 triangles.subspan(first, std::min(kPerTask, triangles.size() - first))) {
                search.check(t);
            }
            context_.check_stop();
        }
        const std::lock_guard lock(mutex);
        far.add(search.far());
    });
    return far;
}

WithinReport PartsProof::run(MeshSource& original_part, MeshSource& simplified, MeshSource& part) {
    context_.begin_stage("prove", 0, "triangles");
    const Surface original = surface_of(original_part);
    const Surface all = surface_of(simplified);
    const Surface checked = surface_of(part);
    Bounds bounds = original.census.bounds;
    bounds.extend(all.census.bounds);
    bounds.extend(checked.census.bounds);
    lattice_ = Lattice(bounds);
    box_ = lattice_.box_from_model(bounds);

    WithinReport report;
    const double steps = distance_ / lattice_.step() - kRounding;
    if (!(steps > kRounding)) return report;
    PieceLimits limits(steps, most_pieces(original.census.n_triangles + all.census.n_triangles));
    const TriangleIndex to_original(context_, load(original), original.census.n_triangles);
    FarPlaces forward = no_places();
    {
        const TriangleIndex to_simplified(context_, load(all), all.census.n_triangles);
        forward = search(to_original.triangles(), to_simplified, limits);
    }
    const FarPlaces backward =
        search(load(checked).span().first(checked.census.n_triangles), to_original, limits);
    context_.end_stage();
    report.n_pieces = limits.n();
    if (limits.is_spent()) return report;
    set_verdict(report, forward, backward, lattice_, options_);
    return report;
}

}  // namespace

WithinReport prove_parts_within(MeshSource& original_part, MeshSource& simplified,
                                MeshSource& simplified_part, double distance,
                                const MeasureOptions& options, const Hooks& hooks) {
    if (!(distance > 0)) throw InvalidArgument("a distance to prove must be above 0");
    return PartsProof(distance, options, hooks).run(original_part, simplified, simplified_part);
}

}  // namespace hewer
