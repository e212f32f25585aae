// SPDX-License-Identifier: MIT
#include "rsimp/fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rsimp/blocks_in_flight.h"
#include "rsimp/border_moves.h"
#include "rsimp/edge_flips.h"
#include "rsimp/face_exchange.h"
#include "rsimp/fit_moves.h"
#include "rsimp/mesh_regions.h"
#include "rsimp/nearest_faces.h"
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
// Edges flip in one of so many rounds: the first has most of what there is to gain.
constexpr unsigned kRoundsPerFlip = 2;
constexpr std::uint64_t kPiece = 1 << 12;

class Fit {
  public:
    Fit(ooc::Context& context, MeshStore& mesh, const ooc::Spool<FitSample>& samples,
        const ooc::Spool<FitSample>& borders, std::span<const cluster::OctreeBox> boxes,
        std::span<const std::uint64_t> first_cluster, std::uint64_t lost_cells)
        : context_(context),
          mesh_(mesh),
          first_positions_(positions_of(context, mesh)),
          regions_(context, mesh, first_positions_, boxes, first_cluster),
          samples_(context, samples, mesh.origin, mesh.vertices.size()),
          borders_(context, borders, mesh.origin, mesh.vertices.size()),
          pull_(samples_.spacing() *
                (static_cast<double>(lost_cells) > kMuchLost * static_cast<double>(samples.size())
                     ? kLeastPull
                     : kMostDistance)),
          flip_reach_(pull_) {
        set_pull(look());
    }

    /// Flips edges before vertices move, if asked for.
    void round(bool flips_edges) {
        flips_edges_ = flips_edges;
        std::optional<FaceExchange> exchange;
        if (flips_edges_) exchange.emplace(context_);
        const Pulled pulled = pull(exchange);
        distance_ = std::sqrt(pulled.distances.mean_square(1));
        set_pull(pulled.distances);
        if (exchange && exchange->carry_out(mesh_)) {
            regions_.find_boxes_of_faces(context_, first_positions_);
        }
        apply(pulled.moves);
    }

    [[nodiscard]] const ooc::Spool<Vec3>& positions() const {
        return moved_.empty() ? first_positions_ : moved_;
    }
    [[nodiscard]] double last_move() const { return last_move_; }
    [[nodiscard]] double distance() const { return distance_; }
    [[nodiscard]] std::uint64_t held() const { return held_; }
    [[nodiscard]] std::uint64_t n_flips() const { return n_flips_; }

  private:
    static constexpr const char* kWhat = "regions of the fit";

    /// The faces around a region that its samples may be nearest to are within this of it.
    [[nodiscard]] double face_reach() const { return reach() + 2 * pull_; }
    [[nodiscard]] double reach() const { return kSampleReach * samples_.spacing(); }

    /// visit(point, hit) for one of `share` samples around a region that have a face within
    /// `most_distance`.
    template <typename Visit>
    void for_each_hit(std::size_t r, const MeshPiece& piece, double most_distance,
                      const Visit& visit, std::uint64_t share = 1) const {
        NearestFaces nearest(context_.workers(), piece);
        samples_.for_each(
            regions_.box(r), reach(), piece.centre,
            [&](std::span<const WeightedPoint> points) {
                const std::span<const FaceTree::Hit> hits = nearest.find(points, most_distance);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    if (hits[i].face != FaceTree::kNone) visit(points[i], hits[i]);
                }
            },
            share);
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
                const MeshPiece piece = regions_.load(r, face_reach(), positions(), vertices);
                FitMoves sums(piece, pull_);
                for_each_hit(
                    r, piece, pull_,
                    [&](const WeightedPoint& point, const FaceTree::Hit& hit) {
                        sums.pull(point, hit.face, hit.squared_distance);
                    },
                    share);
                own = sums.distances();
            },
            [&](std::uint64_t, const DistanceHistogram& own) { all.add(own); });
        return all;
    }

    struct RegionPull {
        std::vector<Vec3> moves;
        DistanceHistogram distances;
        std::vector<std::pair<Face, Face>> exchanges;
        std::uint64_t n_flips = 0;
    };
    /// How the samples would move the vertices of a region, once its edges are flipped.
    void pull(std::size_t r, RegionPull& own) {
        own = {};
        std::vector<std::uint64_t> vertices;
        std::vector<VertexId> ids;
        MeshPiece piece =
            regions_.load(r, face_reach(), positions(), vertices, flips_edges_ ? &ids : nullptr);
        {
            FitMoves sums(piece, pull_);
            if (flips_edges_) {
                flip_edges(r, ids, piece, sums, own);
            } else {
                for_each_hit(r, piece, pull_,
                             [&](const WeightedPoint& point, const FaceTree::Hit& hit) {
                                 sums.pull(point, hit.face, hit.squared_distance);
                             });
            }
            own.moves = sums.moves();
            own.distances = sums.distances();
        }
        // In the memory of the surface's tree.
        BorderMoves borders(piece, kMostDistance * samples_.spacing());
        if (!borders.has_border()) return;
        borders_.for_each(regions_.box(r), reach(), piece.centre,
                          [&](std::span<const WeightedPoint> points) { borders.pull(points); });
        borders.replace(own.moves);
    }

    void flip_edges(std::size_t r, std::span<const VertexId> ids, MeshPiece& piece, FitMoves& sums,
                    RegionPull& own) const {
        EdgeFlips flips(piece);
        for_each_hit(r, piece, flip_reach_,
                     [&](const WeightedPoint& point, const FaceTree::Hit& hit) {
                         if (flips.take(point, hit.face, hit.squared_distance)) return;
                         sums.pull(point, hit.face, hit.squared_distance);
                     });
        const std::vector<EdgeFlips::Change> changes = flips.flip(context_.workers(), piece);
        flips.for_each_point([&](const WeightedPoint& point, std::uint32_t face, float squared) {
            sums.pull(point, face, squared);
        });
        own.n_flips = flips.n_flips();
        const auto with_ids = [&](const LocalFace& face) {
            return Face{ids[face[0]], ids[face[1]], ids[face[2]]};
        };
        for (const EdgeFlips::Change& change : changes) {
            own.exchanges.emplace_back(with_ids(change.before), with_ids(change.after));
        }
    }

    struct Pulled {
        ooc::Spool<Vec3> moves;
        DistanceHistogram distances;
    };
    /// How the samples would move all vertices, and the faces that flips exchange for others.
    Pulled pull(std::optional<FaceExchange>& exchange) {
        Pulled all{{context_, "moves of vertices"}, {}};
        const BlocksInFlight in_flight(context_, kWhat, region_bytes());
        in_flight.sweep<RegionPull>(
            regions_.size(), [&](std::uint64_t r, RegionPull& own) { pull(r, own); },
            [&](std::uint64_t, const RegionPull& own) {
                all.moves.append(own.moves);
                all.distances.add(own.distances);
                for (const auto& [before, after] : own.exchanges) exchange->add(before, after);
                n_flips_ += own.n_flips;
            });
        return all;
    }
    [[nodiscard]] std::uint64_t region_bytes() const {
        const std::uint64_t bytes =
            regions_.region_bytes(face_reach(), flips_edges_ ? EdgeFlips::kBytesPerFace : 0) +
            NearestFaces::kBufferBytes;
        if (!flips_edges_) return bytes;
        std::uint64_t most_points = 0;
        for (std::size_t r = 0; r < regions_.size(); ++r) {
            most_points = std::max(most_points, samples_.points_at_most(regions_.box(r), reach()));
        }
        return bytes + most_points * EdgeFlips::kBytesPerPoint +
               MeshRegions::kMostVertices * sizeof(VertexId);
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
                const MeshPiece piece = regions_.load(r, 0, positions(), vertices);
                const std::vector<Vec3> all = read_places(moves, vertices);
                const std::vector<bool> is_held =
                    held_vertices(piece, read_places(first_positions_, vertices), all);
                result = {};
                result.positions.resize(piece.n_own);
                positions().read(regions_.first_vertex(r), result.positions);
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
        moved_ = std::move(moved);
        last_move_ = std::sqrt(squares / static_cast<double>(moved_.size()));
    }

    ooc::Context& context_;
    MeshStore& mesh_;
    ooc::Spool<Vec3> first_positions_;
    MeshRegions regions_;
    SampleRuns samples_;
    SampleRuns borders_;
    ooc::Spool<Vec3> moved_;
    double pull_;  // up to this distance
    double flip_reach_;
    bool flips_edges_ = false;
    std::uint64_t n_flips_ = 0;
    double last_move_ = 0;
    double distance_ = 0;
    std::uint64_t held_ = 0;
};

}  // namespace

void fit(ooc::Context& context, MeshStore& mesh, const ooc::Spool<FitSample>& samples,
         const ooc::Spool<FitSample>& borders, std::span<const cluster::OctreeBox> boxes,
         std::span<const std::uint64_t> first_cluster, std::uint64_t lost_cells,
         const FitSteps& steps, FitReport& report) {
    Fit fit(context, mesh, samples, borders, boxes, first_cluster, lost_cells);
    report.rounds = steps.rounds;
    for (unsigned i = 0; i < steps.rounds; ++i) {
        fit.round(steps.flips_edges && i % kRoundsPerFlip == 0);
        if (i == 0) report.first_move = fit.last_move();
    }
    report.last_move = fit.last_move();
    report.distance = fit.distance();
    report.held = fit.held();
    report.flips = fit.n_flips();
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
    mesh.vertices = std::move(result);
}

}  // namespace hewer::rsimp
