// SPDX-License-Identifier: MIT
#include "rsimp/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "rsimp/blocks_in_flight.h"
#include "rsimp/border_moves.h"
#include "rsimp/face_window.h"
#include "rsimp/fit_moves.h"
#include "rsimp/mesh_regions.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

namespace {

// Samples farther from the mesh than this do not pull: what has vanished must not drag the surface
// along. So many RMS of the nearest kCommonShare of the surface, or kLeastPull mean distances
// between vertices if that is more; but then no more than kMostFar RMS: on a model with few huge
// faces the mean distance tells nothing of the rest. Never more than kMostDistance mean distances,
// kLeastPull where much has vanished.
constexpr double kLeastPull = 0.1;
constexpr double kMuchLost = 0.02;  // of the samples' cells
constexpr double kFar = 6;
constexpr double kMostFar = 400;
constexpr double kCommonShare = 0.5;
constexpr double kMostDistance = 0.5;
// The common RMS is first looked for in about so many regions, and with so many samples.
constexpr std::uint64_t kRegionsToBegin = 8;
constexpr std::uint64_t kSamplesToBegin = 1 << 11;
// How far around a region samples are looked at: a triangle's length.
constexpr double kSampleReach = 2;
constexpr std::uint64_t kPiece = 1 << 12;

class Fit {
  public:
    Fit(ooc::Context& context, const MeshStore& mesh, const ooc::Spool<FitSample>& samples,
        const ooc::Spool<FitSample>& borders, std::span<const cluster::OctreeBox> boxes,
        std::span<const std::uint64_t> first_cluster, std::uint64_t lost_cells)
        : context_(context),
          mesh_(mesh),
          regions_(context, mesh, boxes, first_cluster),
          samples_(context, samples, mesh.origin, mesh.vertices.size()),
          borders_(context, borders, mesh.origin, mesh.vertices.size()),
          positions_(positions_of(context, mesh)),
          pull_(samples_.spacing() *
                (static_cast<double>(lost_cells) > kMuchLost * static_cast<double>(samples.size())
                     ? kLeastPull
                     : kMostDistance)) {
        set_pull(look());
    }

    void round() {
        const Pulled pulled = pull();
        distance_ = std::sqrt(pulled.distances.mean_square(1));
        set_pull(pulled.distances);
        apply(pulled.moves);
    }

    [[nodiscard]] const ooc::Spool<Vec3>& positions() const { return positions_; }
    [[nodiscard]] double last_move() const { return last_move_; }
    [[nodiscard]] double distance() const { return distance_; }
    [[nodiscard]] std::uint64_t held() const { return held_; }

  private:
    static constexpr const char* kWhat = "regions of the fit";

    /// The faces around a region that its samples may be nearest to are within this of it.
    [[nodiscard]] double face_reach() const { return reach() + 2 * pull_; }
    [[nodiscard]] double reach() const { return kSampleReach * samples_.spacing(); }

    /// Lets one of `share` samples pull the vertices of a region.
    void pull(std::size_t r, const MeshPiece& piece, std::uint64_t share, FitMoves& sums) const {
        samples_.for_each(
            regions_.box(r), reach(), piece.centre,
            [&](std::span<const WeightedPoint> points) { sums.pull(points); }, share);
    }

    /// How far samples are from the mesh, by a few of them.
    DistanceHistogram look() {
        const std::uint64_t stride = std::max<std::uint64_t>(1, regions_.size() / kRegionsToBegin);
        const std::uint64_t share =
            std::max<std::uint64_t>(1, samples_.size() / stride / kSamplesToBegin);
        DistanceHistogram all;
        const BlocksInFlight in_flight(context_, kWhat, region_bytes());
        in_flight.sweep<DistanceHistogram>(
            (regions_.size() + stride - 1) / stride,
            [&](std::uint64_t i, DistanceHistogram& own) {
                const std::uint64_t r = i * stride;
                std::vector<std::uint64_t> vertices;
                const MeshPiece piece = regions_.load(r, face_reach(), positions_, vertices);
                FitMoves sums(context_.workers(), piece, pull_);
                pull(r, piece, share, sums);
                own = sums.distances();
            },
            [&](std::uint64_t, const DistanceHistogram& own) { all.add(own); });
        return all;
    }

    struct Pulled {
        ooc::Spool<Vec3> moves;
        DistanceHistogram distances;
    };
    /// How the samples would move all vertices.
    Pulled pull() {
        Pulled all{{context_, "moves of vertices"}, {}};
        const BlocksInFlight in_flight(context_, kWhat, region_bytes());
        struct Result {
            std::vector<Vec3> moves;
            DistanceHistogram distances;
        };
        in_flight.sweep<Result>(
            regions_.size(),
            [&](std::uint64_t r, Result& own) {
                std::vector<std::uint64_t> vertices;
                const MeshPiece piece = regions_.load(r, face_reach(), positions_, vertices);
                {
                    FitMoves sums(context_.workers(), piece, pull_);
                    pull(r, piece, 1, sums);
                    own = {sums.moves(), sums.distances()};
                }
                // In the memory of the surface's tree.
                BorderMoves borders(piece, kMostDistance * samples_.spacing());
                if (!borders.has_border()) return;
                borders_.for_each(
                    regions_.box(r), reach(), piece.centre,
                    [&](std::span<const WeightedPoint> points) { borders.pull(points); });
                borders.replace(own.moves);
            },
            [&](std::uint64_t, const Result& own) {
                all.moves.append(own.moves);
                all.distances.add(own.distances);
            });
        return all;
    }
    [[nodiscard]] std::uint64_t region_bytes() const {
        return regions_.region_bytes(face_reach()) + FitMoves::kBufferBytes;
    }

    /// For the next round; never farther than before.
    void set_pull(const DistanceHistogram& distances) {
        const double common = std::sqrt(distances.mean_square(kCommonShare));
        const double least = std::min(kMostFar * common, kLeastPull * samples_.spacing());
        pull_ = std::min(pull_, std::max(kFar * common, least));
    }

    void apply(const ooc::Spool<Vec3>& moves) {
        struct Result {
            std::vector<Vec3> positions;
            std::uint64_t held = 0;
            double squares = 0;
        };
        ooc::Spool<Vec3> moved(context_, "positions of vertices");
        held_ = 0;
        double squares = 0;
        const BlocksInFlight in_flight(context_, kWhat, regions_.region_bytes(0));
        in_flight.sweep<Result>(
            regions_.size(),
            [&](std::uint64_t r, Result& result) {
                std::vector<std::uint64_t> vertices;
                const MeshPiece piece = regions_.load(r, 0, positions_, vertices);
                const std::vector<Vec3> all = read_places(moves, vertices);
                const std::vector<bool> is_held =
                    held_vertices(piece, read_positions(mesh_, vertices), all);
                result = {};
                result.positions.resize(piece.n_own);
                positions_.read(regions_.first_vertex(r), result.positions);
                for (std::uint32_t v = 0; v < piece.n_own; ++v) {
                    if (is_held[v]) {
                        ++result.held;
                        continue;
                    }
                    result.positions[v] = result.positions[v] + all[v];
                    result.squares += dot(all[v], all[v]);
                }
            },
            [&](std::uint64_t, const Result& result) {
                moved.append(result.positions);
                held_ += result.held;
                squares += result.squares;
                context_.advance(result.positions.size());
            });
        positions_ = std::move(moved);
        last_move_ = std::sqrt(squares / static_cast<double>(positions_.size()));
    }

    ooc::Context& context_;
    const MeshStore& mesh_;
    MeshRegions regions_;
    SampleRuns samples_;
    SampleRuns borders_;
    ooc::Spool<Vec3> positions_;
    double pull_;  // up to this distance
    double last_move_ = 0;
    double distance_ = 0;
    std::uint64_t held_ = 0;
};

}  // namespace

ooc::Spool<StoredVertex> fit(ooc::Context& context, const MeshStore& mesh,
                             const ooc::Spool<FitSample>& samples,
                             const ooc::Spool<FitSample>& borders,
                             std::span<const cluster::OctreeBox> boxes,
                             std::span<const std::uint64_t> first_cluster, std::uint64_t lost_cells,
                             unsigned rounds, FitReport& report) {
    Fit fit(context, mesh, samples, borders, boxes, first_cluster, lost_cells);
    report.rounds = rounds;
    for (unsigned i = 0; i < rounds; ++i) {
        fit.round();
        if (i == 0) report.first_move = fit.last_move();
    }
    report.last_move = fit.last_move();
    report.distance = fit.distance();
    report.held = fit.held();
    ooc::Spool<StoredVertex> result(context, "vertices");
    std::vector<StoredVertex> vertices;
    std::vector<Vec3> positions;
    for (std::uint64_t first = 0; first < mesh.vertices.size(); first += kPiece) {
        vertices.resize(std::min(kPiece, mesh.vertices.size() - first));
        positions.resize(vertices.size());
        mesh.vertices.read(first, vertices);
        fit.positions().read(first, positions);
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            vertices[i].vertex.position = positions[i];
        }
        result.append(vertices);
        context.check_stop();
    }
    return result;
}

}  // namespace hewer::rsimp
