// SPDX-License-Identifier: MIT
#include "rsimp/feedback.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/distance_histogram.h"
#include "rsimp/face_tree.h"
#include "rsimp/mesh_regions.h"
#include "rsimp/point_tree.h"

namespace hewer::rsimp {

using cluster::CellBlocks;
using cluster::CellRecord;

namespace {

// Multiples of the RMS beyond which a cell is far: of the nearest kCommonShare of the surface, and
// of all of it. The one is for surfaces with noise all over, the other for those that are mostly
// plane.
constexpr double kFar = 6.5;
constexpr double kCommonShare = 0.9;
constexpr double kFarOfAll = 3.5;
// Nothing nearer than this part of the mean distance between vertices is far: the plane parts of a
// model have no RMS to speak of.
constexpr double kLeastFar = 0.01;
// Everything farther than this is: what has vanished must not make itself the norm.
constexpr double kMostFar = 1.5;
// Of the area: what a cell's distance, squared, costs. 1 is its share in the forward error.
constexpr double kStiffness = 2;
// Of what has vanished: with less, small parts do not come back.
constexpr double kStiffnessOfGone = 30;
// How far around a region faces are looked for, in mean distances between vertices.
constexpr double kReach = 2;
// Of the square of that: what was found no nearer, but for rounding.
constexpr double kAsGoodAsReach = 0.99;
// Vertices of the mesh, at most, among which the one nearest to something vanished is looked for.
constexpr std::uint64_t kMostVertices = 1 << 16;
// What a cell without area counts for: it still has a place.
constexpr double kLeastArea = 1e-3;

Vec3 place_of(std::uint64_t code, const CellRecord& cell) {
    const Vec3 mean{static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
                    static_cast<double>(cell.mean[2])};
    return cluster::center_of(code) + mean + cell.mean_beyond();
}

/// How far things are from a mesh that is nowhere near: from its vertices, or from a part of them.
class FarDistances {
  public:
    FarDistances(ooc::Context& context, const MeshStore& mesh, double spacing)
        : stride_((mesh.vertices.size() + kMostVertices - 1) / kMostVertices),
          bytes_(context.budget().reserve(
              "vertices of the feedback",
              PointTree::kBytesPerPoint * (mesh.vertices.size() / stride_ + 1))),
          slack_(stride_ > 1 ? spacing * std::sqrt(static_cast<double>(stride_)) : 0),
          tree_(points_of(mesh, stride_)) {}

    /// A little too small rather than too large where only a part of the vertices is here.
    double operator()(const Vec3& place) {
        tree_.nearest(place, 1, found_, squared_);
        return std::sqrt(squared_.front()) - slack_;
    }

  private:
    static std::vector<Vec3> points_of(const MeshStore& mesh, std::uint64_t stride) {
        std::vector<Vec3> points;
        ooc::SpoolReader<StoredVertex> vertices(mesh.vertices);
        for (std::uint64_t v = 0; const StoredVertex* vertex = vertices.next(); ++v) {
            if (v % stride == 0) points.push_back(vertex->vertex.position);
        }
        return points;
    }

    std::uint64_t stride_;
    ooc::Reservation bytes_;
    double slack_;
    PointTree tree_;
    std::vector<std::size_t> found_;
    std::vector<double> squared_;
};

class Distances {
  public:
    Distances(ooc::Context& context, const CellBlocks& cells, const MeshStore& mesh,
              std::span<const std::uint64_t> first_cluster)
        : context_(context),
          cells_(cells),
          mesh_(mesh),
          positions_(positions_of(context, mesh)),
          regions_(context, mesh, positions_, boxes_of(cells), first_cluster) {
        std::vector<double> areas(regions_.size());
        context.workers().for_ranges(regions_.size(), 1,
                                     [&](std::size_t r, std::size_t) { areas[r] = make_room(r); });
        const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
        spacing_ = std::sqrt(area / static_cast<double>(mesh.vertices.size()));
    }

    /// One of `stride` cells; others have no distance.
    void measure(std::uint64_t stride = 1) {
        squared_ = {context_, "distances of cells"};
        histogram_ = {};
        worst_ = 0;
        std::uint64_t most_cells = 0;
        for (std::size_t r = 0; r < regions_.size(); ++r) {
            most_cells = std::max(most_cells, last_cell(r) - first_cell(r));
        }
        struct Work {
            std::vector<float> squared;
            DistanceHistogram histogram;
        };
        const BlocksInFlight in_flight(context_, "regions of the feedback",
                                       regions_.region_bytes(kReach * spacing_) +
                                           most_cells * sizeof(float) +
                                           2 * ooc::SpoolReader<CellRecord>::kBufferBytes);
        in_flight.sweep<Work>(
            regions_.size(),
            [&](std::uint64_t r, Work& work) {
                work.histogram = {};
                measure_region(r, stride, work.squared, work.histogram);
            },
            [&](std::uint64_t, const Work& work) {
                squared_.append(work.squared);
                histogram_.add(work.histogram);
                for (const float d : work.squared) worst_ = std::max(worst_, d);
            });
    }

    [[nodiscard]] const ooc::Spool<float>& squared() const { return squared_; }
    /// Square of the distance beyond which a cell is far.
    [[nodiscard]] double far_square() const {
        const double common = kFar * kFar * histogram_.mean_square(kCommonShare);
        const double all = kFarOfAll * kFarOfAll * histogram_.mean_square(1);
        const double least = kLeastFar * kLeastFar * spacing_ * spacing_;
        return std::min(std::max({common, all, least}), gone_square());
    }
    /// Beyond this a cell's surface has vanished.
    [[nodiscard]] double gone_square() const { return kMostFar * kMostFar * spacing_ * spacing_; }
    /// As far as anything was looked for: what has this distance may have a larger one.
    [[nodiscard]] double reach_square() const { return kReach * kReach * spacing_ * spacing_; }
    [[nodiscard]] double share_far() const { return histogram_.share_beyond(far_square()); }
    [[nodiscard]] double mean_square() const { return histogram_.mean_square(1); }
    [[nodiscard]] double spacing() const { return spacing_; }
    [[nodiscard]] double worst() const { return std::sqrt(static_cast<double>(worst_)); }

  private:
    static std::vector<cluster::OctreeBox> boxes_of(const CellBlocks& cells) {
        std::vector<cluster::OctreeBox> boxes;
        for (std::size_t b = 0; b < cells.n_blocks(); ++b) boxes.push_back(cells.blocks[b].box);
        return boxes;
    }
    [[nodiscard]] std::uint64_t first_cell(std::size_t region) const {
        return cells_.blocks[regions_.first_octree_box(region)].first_cell;
    }
    [[nodiscard]] std::uint64_t last_cell(std::size_t region) const {
        return cells_.blocks[regions_.first_octree_box(region + 1)].first_cell;
    }

    /// Vertices of a part that vanished are in no region's box; its cells are. Returns their area.
    double make_room(std::size_t region) {
        FloatBox box;
        double area = 0;
        ooc::SpoolReader<std::uint64_t> codes(cells_.codes, first_cell(region), last_cell(region));
        ooc::SpoolReader<CellRecord> cells(cells_.cells, first_cell(region), last_cell(region));
        while (const std::uint64_t* code = codes.next()) {
            const Vec3 centre = cluster::center_of(*code) - mesh_.origin;
            box.extend(centre - Vec3{0.5, 0.5, 0.5});
            box.extend(centre + Vec3{0.5, 0.5, 0.5});
            area += static_cast<double>(cells.next()->area);
        }
        regions_.extend(region, box);
        return area;
    }

    void measure_region(std::size_t region, std::uint64_t stride, std::vector<float>& squared,
                        DistanceHistogram& histogram) const {
        const double reach = kReach * spacing_;
        std::vector<std::uint64_t> vertices;
        const MeshPiece piece = regions_.load(region, reach, positions_, vertices);
        squared.assign(last_cell(region) - first_cell(region), 0.0F);
        if (piece.faces.empty()) return;  // too many of them
        std::vector<Point3f> points(piece.positions.size());
        for (std::size_t v = 0; v < points.size(); ++v) {
            points[v] = to_single(piece.positions[v]);
        }
        const FaceTree tree(points, piece.faces);
        const auto most = static_cast<float>(reach * reach);
        ooc::SpoolReader<CellRecord> cells(cells_.cells, first_cell(region), last_cell(region));
        ooc::SpoolReader<std::uint64_t> codes(cells_.codes, first_cell(region), last_cell(region));
        std::uint32_t guess = 0;
        std::vector<Point3f> places;
        std::vector<FaceTree::Hit> hits;
        std::size_t n_done = 0;
        std::vector<std::size_t> measured;
        for (auto run = cells.next_piece(); !run.empty(); run = cells.next_piece()) {
            places.clear();
            measured.clear();
            for (std::size_t i = 0; i < run.size(); ++i) {
                const std::uint64_t code = *codes.next();
                if ((n_done + i) % stride != 0) continue;
                const Vec3 place = place_of(code, run[i]) - mesh_.origin;
                places.push_back(to_single(place - piece.centre));
                measured.push_back(i);
            }
            hits.resize(places.size());
            tree.nearest(places, most, guess, hits);
            for (std::size_t k = 0; k < measured.size(); ++k) {
                const std::size_t i = measured[k];
                const float d = squared[n_done + i] = hits[k].squared_distance;
                histogram.add(d, run[i].area);
            }
            n_done += run.size();
            context_.advance(run.size());
        }
    }

    ooc::Context& context_;
    const CellBlocks& cells_;
    const MeshStore& mesh_;
    ooc::Spool<Vec3> positions_;
    MeshRegions regions_;
    ooc::Spool<float> squared_;  // by cell
    double spacing_ = 0;
    DistanceHistogram histogram_;
    float worst_ = 0;
};

}  // namespace

FeedbackResult feed_back(ooc::Context& context, const CellBlocks& cells, const MeshStore& mesh,
                         std::span<const std::uint64_t> first_cluster, double far_distance,
                         const FeedbackLook& look) {
    Distances distances(context, cells, mesh, first_cluster);
    FeedbackResult result;
    if (look.least_share > 0) {
        distances.measure(look.stride);
        result.is_made = distances.share_far() >= look.least_share;
        if (!result.is_made) return result;
    }
    distances.measure();
    result.cells = {context, "cells"};
    result.worst = distances.worst();
    result.mean_square = distances.mean_square();
    const double bound = far_distance > 0 ? far_distance * far_distance : distances.far_square();
    const double gone = distances.gone_square();
    result.has_vanished = result.worst * result.worst > gone;
    std::optional<FarDistances> far;
    if (result.has_vanished || !cells.vanished.empty()) {
        result.vanished = {context, "distances of what has vanished"};
        far.emplace(context, mesh, distances.spacing());
    }
    ooc::SpoolReader<CellRecord> records(cells.cells);
    ooc::SpoolReader<std::uint64_t> codes(cells.codes);
    ooc::SpoolReader<float> squared(distances.squared());
    ooc::SpoolReader<float> vanished_before(cells.vanished);
    std::vector<CellRecord> stiffer;
    std::vector<float> vanished;
    for (auto piece = records.next_piece(); !piece.empty(); piece = records.next_piece()) {
        stiffer.assign(piece.begin(), piece.end());
        vanished.clear();
        for (CellRecord& cell : stiffer) {
            const auto d = static_cast<double>(*squared.next());
            const std::uint64_t code = *codes.next();
            const bool has_vanished = d > gone;
            if (far) {
                const float before = cells.vanished.empty() ? 0 : *vanished_before.next();
                double now = has_vanished ? d : 0;
                if (d >= kAsGoodAsReach * distances.reach_square()) {
                    const double distance = (*far)(place_of(code, cell) - mesh.origin);
                    if (distance > 0) now = std::max(now, distance * distance);
                }
                vanished.push_back(std::max(before, static_cast<float>(now)));
            }
            if (d <= bound) continue;
            ++result.n_far;
            const double weight = (has_vanished ? kStiffnessOfGone : kStiffness) * (1 - bound / d) *
                                  std::max(kLeastArea, static_cast<double>(cell.area));
            for (const std::size_t diagonal : {0U, 3U, 5U}) {
                cell.quadric[diagonal] += static_cast<float>(weight);
            }
        }
        result.cells.append(stiffer);
        if (far) result.vanished.append(vanished);
        context.check_stop();
    }
    return result;
}

}  // namespace hewer::rsimp
