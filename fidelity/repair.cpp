// SPDX-License-Identifier: MIT
#include "fidelity/repair.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fidelity/failing_places.h"
#include "fidelity/neighbourhood.h"
#include "fidelity/pull_to_points.h"
#include "hewer/nearest_points.h"

namespace hewer::fidelity {

namespace {

constexpr unsigned kMostRounds = 64;
// Of the whole level.
constexpr unsigned kMostProofs = 8;
// Rounds with no fewer places than there have been since the last proof of the whole.
constexpr unsigned kMostIdle = 16;
// How many triangles come: of a level's own, in thousandths, and besides.
constexpr std::uint64_t kMostMore = 30;
constexpr std::uint64_t kFewMore = 64;
// From this round on the ways take turns: two places whose faces share a corner can undo each
// other's nudges for ever.
constexpr unsigned kFirstOfTurns = 5;
constexpr std::array kTurns{Pull::By::Flip, Pull::By::Distance, Pull::By::Vertex,
                            Pull::By::Distance};
// Moving corners for one place can take them from another: so many times all are looked after that
// have been before, up to some of the last.
constexpr double kStillWithin = 0.98;
constexpr unsigned kSweeps = 8;
constexpr std::ptrdiff_t kMostPast = 400;
// Of the bound, how far a place may be after it was pulled. Less moves more of what was well.
constexpr double kWellWithin = 0.9;
// Bounds: what is farther has no counterpart.
constexpr double kFarthest = 4;

/// What is too far, and where it should be.
struct Far {
    double distance = 0;
    Pull pull;
    bool is_of_level = false;  // rather than of the original
};

class Repair {
  public:
    Repair(const Judge& judge, double bound, double spacing, KeptMesh& mesh, LodReport& lod,
           const Hooks& hooks)
        : judge_(judge),
          bound_(bound),
          mesh_(mesh),
          lod_(lod),
          found_(*lod.measured),
          hooks_(hooks),
          near_(judge, std::max(kFarthest * bound, spacing)),
          most_triangles_(lod.triangles + lod.triangles * kMostMore / 1000 + kFewMore) {}

    bool run(const std::function<void(const LodReport&)>& on_round) {
        bool has_changed = false;
        for (unsigned round = 0; round < kMostRounds && n_idle_ < kMostIdle; ++round) {
            if (lod_.triangles >= most_triangles_ || n_proofs_ == kMostProofs ||
                largest_distance(found_) <= bound_ || !fails_in_places(found_, bound_)) {
                break;
            }
            if (!pull(round)) break;
            has_changed = true;
            on_round(lod_);
        }
        return has_changed;
    }

  private:
    bool pull(unsigned round);
    std::vector<Far> far_places();
    void hold_earlier(std::span<const Pull> pulls, PullReport& pulled);
    void count(const PullReport& pulled);
    void judge_again(const PullReport& pulled);
    [[nodiscard]] Mesh part_of_level(std::span<const std::uint64_t> faces) const;

    const Judge& judge_;
    double bound_;
    KeptMesh& mesh_;
    LodReport& lod_;
    MeasureReport& found_;
    const Hooks& hooks_;
    Neighbourhood near_;
    std::uint64_t most_triangles_;
    std::vector<Pull> past_;
    unsigned n_proofs_ = 0;
    unsigned n_idle_ = 0;
    std::size_t fewest_ = std::numeric_limits<std::size_t>::max();
};

/// All that is too far, worst first; of too much the worse half, or the worse half of that, and so
/// on: the rest will be found again. near_ has what is near them.
std::vector<Far> Repair::far_places() {
    std::vector<Far> far;
    for (const WorstPlace& place : found_.forward.worst) {
        far.push_back({place.distance, {place.point, place.point}, false});
    }
    for (const WorstPlace& place : found_.backward.worst) {
        far.push_back({place.distance, {place.point, {}}, true});
    }
    std::erase_if(far, [&](const Far& place) { return !(place.distance > bound_); });
    std::stable_sort(far.begin(), far.end(),
                     [](const Far& a, const Far& b) { return a.distance > b.distance; });
    const auto boxes = [&] {
        std::vector<Bounds> each(far.size());
        for (std::size_t i = 0; i < far.size(); ++i) each[i].extend(far[i].pull.from);
        return each;
    };
    while (!far.empty() && !near_.include(boxes(), hooks_)) far.resize(far.size() / 2);

    std::vector<Vec3> points;
    for (const Far& place : far) {
        if (place.is_of_level) points.push_back(place.pull.from);
    }
    const auto nearest = nearest_points(*view_mesh(near_.mesh(), "near places"), points,
                                        kFarthest * bound_, judge_.options(), hooks_);
    std::vector<Far> with_counterpart;
    with_counterpart.reserve(far.size());
    std::size_t n = 0;
    for (Far& place : far) {
        if (place.is_of_level) {
            const std::optional<Vec3>& to = nearest[n++];
            if (!to) continue;
            place.pull.to = *to;
        }
        with_counterpart.push_back(place);
    }
    return with_counterpart;
}

/// One round. False if nothing could be done.
bool Repair::pull(unsigned round) {
    std::vector<Pull> pulls;
    for (const Far& far : far_places()) {
        Pull pull = far.pull;
        pull.near = kWellWithin * bound_;
        pull.by = round < kFirstOfTurns ? Pull::By::Distance : kTurns[round % kTurns.size()];
        pulls.push_back(pull);
    }
    PullReport pulled = mesh_.pull(pulls);
    if (pulled.n_done == 0) return false;
    hold_earlier(pulls, pulled);
    // The places of the first round are those of a few samples: their number tells nothing.
    if (round > 0) {
        n_idle_ = pulls.size() < fewest_ ? 0 : n_idle_ + 1;
        fewest_ = std::min(fewest_, pulls.size());
    }
    count(pulled);
    judge_again(pulled);
    return true;
}

/// Nudges back what these pulls and others after them have taken from the earlier ones.
void Repair::hold_earlier(std::span<const Pull> pulls, PullReport& pulled) {
    for (Pull pull : pulls) {
        pull.by = Pull::By::Corners;
        pull.near = kStillWithin * bound_;
        past_.push_back(pull);
    }
    if (past_.size() > kMostPast) past_.erase(past_.begin(), past_.end() - kMostPast);
    for (unsigned i = 0; i < kSweeps; ++i) {
        const PullReport again = mesh_.pull(past_);
        if (again.n_done == 0) break;
        pulled.faces.insert(pulled.faces.end(), again.faces.begin(), again.faces.end());
        pulled.boxes.insert(pulled.boxes.end(), again.boxes.begin(), again.boxes.end());
    }
    std::sort(pulled.faces.begin(), pulled.faces.end());
    pulled.faces.erase(std::unique(pulled.faces.begin(), pulled.faces.end()), pulled.faces.end());
}

void Repair::count(const PullReport& pulled) {
    lod_.triangles += pulled.triangles;
    lod_.vertices += pulled.vertices;
    lod_.topology.border_edges += pulled.border_edges;
    lod_.bounds = mesh_.bounds();
}

void Repair::judge_again(const PullReport& pulled) {
    // That most of both surfaces is near stays true.
    for (DistanceReport* side : {&found_.forward, &found_.backward}) {
        side->maximum = 0;
        side->worst.clear();
    }
    const std::unique_ptr<MeshSource> level = mesh_.source("try");
    if (near_.include(pulled.boxes, hooks_) &&
        !judge_.prove_parts(near_.mesh(), *level, part_of_level(pulled.faces), bound_, found_,
                            hooks_)) {
        return;
    }
    ++n_proofs_;
    n_idle_ = 0;
    fewest_ = std::numeric_limits<std::size_t>::max();
    if (judge_.prove(*level, bound_, found_, hooks_)) {
        lod_.proven_within = bound_;
        found_ = judge_.look(*level, hooks_);
    }
}

Mesh Repair::part_of_level(std::span<const std::uint64_t> faces) const {
    Mesh part;
    for (const std::uint64_t f : faces) {
        const std::uint64_t first = part.positions.size();
        for (const std::uint64_t v : mesh_.mesh().triangles[f]) {
            part.positions.push_back(mesh_.mesh().positions[v]);
        }
        part.triangles.push_back({first, first + 1, first + 2});
    }
    return part;
}

}  // namespace

bool repair(const Judge& judge, double bound, double spacing, KeptMesh& mesh, LodReport& lod,
            const Hooks& hooks, const std::function<void(const LodReport&)>& on_round) {
    return Repair(judge, bound, spacing, mesh, lod, hooks).run(on_round);
}

}  // namespace hewer::fidelity
