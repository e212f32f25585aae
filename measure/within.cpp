// SPDX-License-Identifier: MIT
#include "hewer/within.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "measure/census.h"
#include "measure/far_places.h"
#include "measure/lattice.h"
#include "measure/limits.h"
#include "measure/piece.h"
#include "measure/piece_limits.h"
#include "measure/piece_search.h"
#include "measure/points.h"
#include "measure/resident_surface.h"
#include "measure/triangle_index.h"
#include "measure/verdict.h"
#include "measure/waiting_points.h"
#include "ooc/context.h"
#include "ooc/parallel.h"
#include "ooc/spool.h"
#include "streaming/dereference.h"

namespace hewer {

namespace {

using namespace measuring;

// Raw and decoded blocks of vertices and triangles, for each worker.
constexpr std::uint64_t kBatchBytes = 2 << 20;
// Of a batch of waiting pieces: with fewer, most of the time goes into reading the original.
constexpr std::uint64_t kLeastWaiting = 1 << 14;
// Pieces that have waited, looked at by a thread at once.
constexpr std::uint64_t kPerTask = 1 << 12;
// Rounds of what is left, each a pass over the original; twenty do for most.
constexpr int kMostRounds = 64;
// Of a piece that waits for the first time: its longest edge is at most the distance and so many
// edges of the original, whose triangles are taken for equilateral.
constexpr double kEdges = 1.0;
constexpr double kTriangleArea = 0.43;  // of an edge's square

class Proof {
  public:
    Proof(MeshSource& original, MeshSource& simplified, double distance,
          const MeasureOptions& options, const Hooks& hooks)
        : original_(original),
          simplified_(simplified),
          distance_(distance),
          options_(options),
          context_(limits_of(options), hooks, {{"scan", 2}, {"load", 1}, {"prove", 10}}) {}

    WithinReport run();

  private:
    Census census_of(MeshSource& source);
    void load(const Census& simplified);
    [[nodiscard]] ooc::Spool<Piece> first_pieces(PieceLimits& limits);
    [[nodiscard]] std::uint64_t most_waiting();
    void decide(PieceLimits& limits, WithinReport& report);
    struct Rest {
        std::vector<Piece> pieces;
        std::vector<FarPlaces::Place> far;
    };
    static Rest check(const WaitingPoints& waiting, std::uint64_t begin, std::uint64_t end,
                      const PieceLimits& limits);
    void check_batch(const WaitingPoints& waiting, PieceLimits& limits, ooc::Spool<Piece>& next,
                     FarPlaces& far);
    void stream_past(WaitingPoints& waiting, std::span<PieceSearch> searches);

    MeshSource& original_;
    MeshSource& simplified_;
    double distance_;
    const MeasureOptions& options_;
    ooc::Context context_;
    ooc::HeldInput held_original_{context_.hold(original_)};
    ooc::HeldInput held_simplified_{context_.hold(simplified_)};
    Lattice lattice_;
    Census census_;  // of the original
    std::uint64_t window_bytes_ = 0;
    TriangleIndex index_;  // of the simplified surface
    Bounds box_;           // of both, in steps
};

Census Proof::census_of(MeshSource& source) {
    return take_census_of_surface(context_, source,
                                  std::min(kMostWindowBytes, context_.budget().available() / 4));
}

void Proof::load(const Census& simplified) {
    Bounds both = census_.bounds;
    both.extend(simplified.bounds);
    lattice_ = Lattice(both);
    box_ = lattice_.box_from_model(both);
    ResidentSurface surface = load_surface(context_, simplified_, simplified, lattice_);
    surface.points.release();
    index_ = TriangleIndex(context_, std::move(surface.triangles), simplified.n_triangles);
}

/// Not larger than what the triangles of the original can be near to: those would be halved anyway,
/// after a pass over the original.
ooc::Spool<Piece> Proof::first_pieces(PieceLimits& limits) {
    const double square_step = lattice_.step() * lattice_.step();
    const double area = census_.area / square_step / static_cast<double>(census_.n_triangles);
    const double longest = std::sqrt(limits.near()) + kEdges * std::sqrt(area / kTriangleArea);
    ooc::Spool<Piece> pieces(context_, "pieces of the simplified surface");
    std::vector<Piece> pending;
    for (const LatticeTriangle& t : index_.triangles()) {
        pending.assign(1, t);
        while (!pending.empty() && !limits.is_spent()) {
            const Piece piece = pending.back();
            pending.pop_back();
            if (squared_edge(piece, longest_edge(piece)) <= longest * longest) {
                pieces.push(piece);
                limits.count(1);
                continue;
            }
            for (const Piece& half : halves_of(piece)) pending.push_back(half);
        }
    }
    pieces.seal();
    return pieces;
}

/// Half of what is left beside the window: what is left of them comes on top.
std::uint64_t Proof::most_waiting() {
    constexpr std::uint64_t kMany = 1 << 20;
    const std::uint64_t each = WaitingPoints::piece_bytes(kMany) / kMany + 1;
    const std::uint64_t besides = window_bytes_ + context_.n_threads() * kBatchBytes;
    const std::uint64_t available = context_.budget().available();
    return std::max(kLeastWaiting, (available - std::min(available, besides)) / 2 / each);
}

/// With one of `searches` for each worker, if any.
void Proof::stream_past(WaitingPoints& waiting, std::span<PieceSearch> searches) {
    streaming::Dereference<LatticeEncoder> triangles(context_, original_, {lattice_}, window_bytes_,
                                                     census_.coherence);
    triangles.for_batches(
        [] {},
        [&](unsigned worker, std::span<const LatticeTriangle> batch, std::span<const Triangle>) {
            waiting.meet(batch);
            if (searches.empty()) return;
            for (const LatticeTriangle& t : batch) searches[worker].check(t);
        });
}

/// What is left of pieces [begin, end) of those that waited.
Proof::Rest Proof::check(const WaitingPoints& waiting, std::uint64_t begin, std::uint64_t end,
                         const PieceLimits& limits) {
    Rest rest;
    for (std::uint64_t i = begin; i < end; ++i) {
        const double bound = waiting.squared_distance(i);
        if (bound <= limits.near()) continue;
        const Piece& piece = waiting.piece(i);
        // Not even the center, or too small to halve.
        if (std::isinf(bound) || limits.is_hair(squared_radius(piece))) {
            rest.far.push_back({std::isinf(bound) ? limits.near() : bound, waiting.point(i)});
            continue;
        }
        for (const Piece& part : rest_of(piece, waiting.nearest(i), limits.near())) {
            rest.pieces.push_back(part);
        }
    }
    return rest;
}

/// What is left where a piece is neither near nor far goes to `next`.
void Proof::check_batch(const WaitingPoints& waiting, PieceLimits& limits, ooc::Spool<Piece>& next,
                        FarPlaces& far) {
    context_.workers().in_order(
        (waiting.size() + kPerTask - 1) / kPerTask, 2 * context_.n_threads(),
        [&](std::uint64_t task) {
            const std::uint64_t begin = task * kPerTask;
            return check(waiting, begin, std::min(begin + kPerTask, waiting.size()), limits);
        },
        [&](std::uint64_t, const Rest& rest) {
            next.append(rest.pieces);
            limits.count(rest.pieces.size());
            for (const FarPlaces::Place& p : rest.far) far.add(p.point, p.squared_distance);
        });
}

void Proof::decide(PieceLimits& limits, WithinReport& report) {
    const double apart = options_.places_apart * box_.diagonal();
    FarPlaces backward(context_, box_, apart);
    ooc::Spool<Piece> pending = first_pieces(limits);
    std::vector<PieceSearch> searches;
    for (unsigned i = 0; i < context_.n_threads(); ++i) {
        searches.emplace_back(index_, limits, FarPlaces(context_, box_, apart));
    }
    // To the end, though a place is far already: the others are wanted, too.
    for (int round = 0; round < kMostRounds && !pending.empty() && !limits.is_spent(); ++round) {
        ooc::Spool<Piece> next(context_, "rests of pieces of the simplified surface");
        const std::uint64_t n_batch = most_waiting();
        for (std::uint64_t first = 0; first < pending.size(); first += n_batch) {
            if (limits.is_spent()) return;
            ooc::Array<Piece> pieces(context_.budget(), "pieces of the simplified surface",
                                     std::min(n_batch, pending.size() - first));
            pending.read(first, pieces.span());
            WaitingPoints waiting(context_, std::move(pieces), limits.near());
            // The original's own pieces are looked at as it passes for the first time.
            const bool is_first = round == 0 && first == 0;
            stream_past(waiting, is_first ? std::span(searches) : std::span<PieceSearch>());
            check_batch(waiting, limits, next, backward);
        }
        pending = std::move(next);
    }
    FarPlaces forward(context_, box_, apart);
    for (const PieceSearch& search : searches) forward.add(search.far());
    const bool is_near = forward.empty() && backward.empty();
    if (limits.is_spent() || (is_near && !pending.empty())) return;
    set_verdict(report, forward, backward, lattice_, options_);
}

WithinReport Proof::run() {
    context_.begin_stage("scan", original_.info().n_faces + simplified_.info().n_faces, "faces");
    const Census simplified = census_of(simplified_);
    census_ = census_of(original_);
    context_.end_stage();
    context_.begin_stage("load", simplified_.info().n_faces + simplified_.info().n_vertices,
                         "elements");
    load(simplified);
    context_.end_stage();
    window_bytes_ = std::min(kMostWindowBytes, context_.budget().available() / 4);

    WithinReport report;
    // What the lattice takes from both surfaces, and halving.
    const double steps = distance_ / lattice_.step() - kRounding;
    if (!(steps > kRounding)) return report;
    PieceLimits limits(steps, most_pieces(census_.n_triangles + simplified.n_triangles));
    context_.begin_stage("prove", 0, "faces");
    decide(limits, report);
    context_.end_stage();
    report.n_pieces = limits.n();
    return report;
}

}  // namespace

double WithinReport::farthest() const {
    double most = 0;
    for (const std::vector<WorstPlace>* places : {&forward, &backward}) {
        if (!places->empty()) most = std::max(most, places->front().distance);
    }
    return most;
}

WithinReport prove_within(MeshSource& original, MeshSource& simplified, double distance,
                          const MeasureOptions& options, const Hooks& hooks) {
    if (!(distance > 0)) throw InvalidArgument("a distance to prove must be above 0");
    return Proof(original, simplified, distance, options, hooks).run();
}

}  // namespace hewer
