// SPDX-License-Identifier: MIT
#include "fidelity/repair.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "fidelity/failing_places.h"
#include "fidelity/pull_to_points.h"
#include "hewer/nearest_points.h"

namespace hewer::fidelity {

namespace {

constexpr unsigned kMostRounds = 24;
// Rounds with no fewer places than there have been before.
constexpr unsigned kMostIdle = 8;
// How many triangles come: of a level's own, in thousandths, and besides.
constexpr std::uint64_t kMostMore = 30;
constexpr std::uint64_t kFewMore = 64;
// From this round on, vertices and nudges take turns: two places whose faces share a corner can
// undo each other's nudges for ever.
constexpr unsigned kFirstOfVertices = 5;
// Of the bound, how far a place may be after it was pulled. Less moves more of what was well.
constexpr double kWellWithin = 0.9;
// Bounds: what is farther has no counterpart.
constexpr double kFarthest = 4;

/// For all that is too far, worst first.
std::vector<Pull> pulls_of(const Judge& judge, double bound, const MeasureReport& m,
                           const Hooks& hooks) {
    std::vector<std::pair<double, Pull>> far;
    const auto add = [&](const Vec3& from, const Vec3& to, double distance) {
        far.push_back({distance, {from, to, kWellWithin * bound}});
    };
    for (const WorstPlace& place : m.forward.worst) {
        if (place.distance > bound) add(place.point, place.point, place.distance);
    }
    std::vector<Vec3> points;
    std::vector<double> distances;
    for (const WorstPlace& place : m.backward.worst) {
        if (!(place.distance > bound)) continue;
        points.push_back(place.point);
        distances.push_back(place.distance);
    }
    const auto nearest =
        nearest_points(judge.original(), points, kFarthest * bound, judge.options(), hooks);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (nearest[i]) add(points[i], *nearest[i], distances[i]);
    }
    std::stable_sort(far.begin(), far.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Pull> pulls;
    pulls.reserve(far.size());
    for (const auto& [distance, pull] : far) pulls.push_back(pull);
    return pulls;
}

}  // namespace

bool repair(const Judge& judge, double bound, KeptMesh& mesh, LodReport& lod, const Hooks& hooks,
            const std::function<void(const LodReport&)>& on_round) {
    MeasureReport& found = *lod.measured;
    const std::uint64_t most = lod.triangles + lod.triangles * kMostMore / 1000 + kFewMore;
    bool has_changed = false;
    // The places of the first round are those of a few samples: their number tells nothing.
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    unsigned n_idle = 0;
    for (unsigned round = 0; round < kMostRounds && n_idle < kMostIdle; ++round) {
        if (largest_distance(found) <= bound || lod.triangles >= most ||
            !fails_in_places(found, bound)) {
            break;
        }
        std::vector<Pull> pulls = pulls_of(judge, bound, found, hooks);
        const bool by_vertex = round >= kFirstOfVertices && (round - kFirstOfVertices) % 2 == 0;
        for (Pull& pull : pulls) pull.by_vertex = by_vertex;
        const PullReport pulled = mesh.pull(pulls);
        if (pulled.n_done == 0) break;
        has_changed = true;
        if (round > 0) {
            n_idle = pulls.size() < fewest ? 0 : n_idle + 1;
            fewest = std::min(fewest, pulls.size());
        }
        lod.triangles += pulled.triangles;
        lod.vertices += pulled.vertices;
        lod.topology.border_edges += pulled.border_edges;
        lod.bounds = mesh.bounds();
        // That most of both surfaces is near stays true.
        for (DistanceReport* side : {&found.forward, &found.backward}) {
            side->maximum = 0;
            side->worst.clear();
        }
        const std::unique_ptr<MeshSource> level = mesh.source("try");
        if (judge.prove(*level, bound, found, hooks)) {
            lod.proven_within = bound;
            found = judge.look(*level, hooks);
        }
        on_round(lod);
    }
    return has_changed;
}

}  // namespace hewer::fidelity
