// SPDX-License-Identifier: MIT
#include "rsimp/folded_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "cluster/hash.h"
#include "ooc/vec3.h"
#include "rsimp/blocks_in_flight.h"
#include "rsimp/half_edges.h"
#include "rsimp/mesh_regions.h"
#include "rsimp/sample_runs.h"

namespace hewer::rsimp {

namespace {

// A sample that faces as the face does counts up to so many times the distance of the nearest that
// does not.
constexpr double kFrontShare = 1.5;
constexpr std::array kSteps{0.25, 0.5, 0.75, 1.0};
// Bytes of a region's faces: distances, order in the grid, corners by vertex.
constexpr std::uint64_t kBytesPerFace = 70;

struct Placed {
    Vec3 centre{};
    Vec3 normal{};  // not unit; zero: no area
};

Placed place(const std::array<Vec3, 3>& p) {
    return {(1.0 / 3) * (p[0] + p[1] + p[2]), cross(p[1] - p[0], p[2] - p[0])};
}

/// Squared distances of the nearest samples that face as a face does, and that do not.
struct NearestSides {
    double front = std::numeric_limits<double>::infinity();
    double back = std::numeric_limits<double>::infinity();

    void add(const Placed& face, const WeightedPoint& sample) {
        const Vec3 way = as_vec3(sample.position) - face.centre;
        double& nearest = dot(face.normal, as_vec3(sample.normal)) < 0 ? back : front;
        nearest = std::min(nearest, dot(way, way));
    }
    /// With samples of all places nearer than `reach`, `spacing` apart.
    [[nodiscard]] bool is_folded(double reach, double spacing) const {
        const double nearest_back = std::sqrt(back);
        return kFrontShare * nearest_back <= reach &&
               std::sqrt(front) > std::max(spacing, kFrontShare * nearest_back);
    }
};

/// Points by the cells of a grid.
class PointGrid {
  public:
    PointGrid(const std::vector<Vec3>& points, double edge) : edge_(edge) {
        FloatBox box;
        for (const Vec3& p : points) box.extend(p);
        for (std::size_t k = 0; k < 3; ++k) {
            low_[k] = static_cast<double>(box.low[k]);
            const double length = static_cast<double>(box.high[k]) - low_[k];
            // Wide regions of few points must not have many more cells than points.
            n_[k] = static_cast<std::uint64_t>(std::clamp(length / edge, 0.0, kMostCells)) + 1;
        }
        while (n_[0] * n_[1] * n_[2] > kCellsPerPoint * points.size() + 8) {
            edge_ *= 2;
            for (std::uint64_t& n : n_) n = n / 2 + 1;
        }
        start_.resize(n_[0] * n_[1] * n_[2] + 1);
        std::vector<std::uint32_t> cell(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::array<std::uint64_t, 3> at;
            for (std::size_t k = 0; k < 3; ++k) at[k] = place(points[i][k], k);
            cell[i] = static_cast<std::uint32_t>(index(at));
            ++start_[cell[i] + 1];
        }
        for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
        std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
        points_.resize(points.size());
        for (std::uint32_t i = 0; i < points.size(); ++i) points_[next[cell[i]]++] = i;
    }

    /// visit(i) for all points within `reach` of p, and some more.
    template <typename Visit>
    void for_each_near(const Vec3& p, double reach, const Visit& visit) const {
        std::array<std::uint64_t, 3> low;
        std::array<std::uint64_t, 3> high;
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = place(p[k] - reach, k);
            high[k] = place(p[k] + reach, k);
        }
        for (std::uint64_t x = low[0]; x <= high[0]; ++x) {
            for (std::uint64_t y = low[1]; y <= high[1]; ++y) {
                const std::uint32_t begin = start_[index({x, y, low[2]})];
                const std::uint32_t end = start_[index({x, y, high[2]}) + 1];
                for (std::uint32_t i = begin; i < end; ++i) visit(points_[i]);
            }
        }
    }

  private:
    static constexpr double kMostCells = 1 << 20;
    static constexpr std::uint64_t kCellsPerPoint = 4;

    [[nodiscard]] std::uint64_t place(double x, std::size_t axis) const {
        const double at = (x - low_[axis]) / edge_;
        return at > 0 ? std::min(static_cast<std::uint64_t>(std::min(at, kMostCells)), n_[axis] - 1)
                      : 0;
    }
    [[nodiscard]] std::uint64_t index(const std::array<std::uint64_t, 3>& at) const {
        return (at[0] * n_[1] + at[1]) * n_[2] + at[2];
    }

    double edge_;
    std::array<double, 3> low_{};
    std::array<std::uint64_t, 3> n_{};
    std::vector<std::uint32_t> start_;
    std::vector<std::uint32_t> points_;
};

std::uint64_t cell_code(const std::array<std::int64_t, 3>& cell) {
    constexpr unsigned kBits = 21;
    std::uint64_t code = 0;
    for (const std::int64_t c : cell) {
        code = code << kBits | (static_cast<std::uint64_t>(c) & ((1U << kBits) - 1));
    }
    return code;
}

/// A few codes that many others are to be told from.
class CodeSet {
  public:
    void add(std::uint64_t code) {
        codes_.push_back(code);
        may_have_[place(code)] = true;
    }
    /// Before contains().
    void finish() {
        std::sort(codes_.begin(), codes_.end());
        codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
    }
    [[nodiscard]] bool contains(std::uint64_t code) const {
        return may_have_[place(code)] && std::binary_search(codes_.begin(), codes_.end(), code);
    }

  private:
    static constexpr unsigned kBits = 16;
    static std::size_t place(std::uint64_t code) {
        return cluster::well_scattered(code) >> (64 - kBits);
    }
    std::vector<std::uint64_t> codes_;
    std::vector<bool> may_have_ = std::vector<bool>(std::size_t{1} << kBits);
};

using Move = std::pair<std::uint64_t, Vec3>;  // rank of a vertex and its new place

bool is_before(const FoldedFace& a, const FoldedFace& b) {
    return a.size != b.size ? a.size > b.size : a.center < b.center;
}

void add_face(FoldedFaces& folded, const FoldedFace& face) {
    ++folded.faces;
    std::vector<FoldedFace>& list = folded.list;
    if (list.size() == FoldedFaces::kMostListed && !is_before(face, list.back())) return;
    list.insert(std::upper_bound(list.begin(), list.end(), face, is_before), face);
    if (list.size() > FoldedFaces::kMostListed) list.pop_back();
}

/// One region: its folded faces, and the moves that turn them back.
class Region {
  public:
    Region(MeshPiece piece, const SampleRuns& samples, double reach, double spacing)
        : piece_(std::move(piece)), samples_(samples), reach_(reach), spacing_(spacing) {
        // Only those with an own corner: nothing else was asked for.
        placed_.reserve(piece_.faces.size());
        for (std::uint32_t f = 0; f < piece_.faces.size(); ++f) placed_.push_back(place_of(f));
        find_folded();
    }

    [[nodiscard]] const std::vector<std::uint32_t>& folded() const { return folded_; }
    [[nodiscard]] const MeshPiece& piece() const { return piece_; }

    /// Moves vertices as long as that turns faces back; ranks are counted from `first_vertex`.
    std::vector<Move> turn_back(std::uint64_t first_vertex, double most_move) {
        std::vector<Move> moves;
        most_move_ = most_move;
        if (folded_.empty()) return moves;
        find_corners();
        gather_samples();
        for (const std::uint32_t f : std::vector(folded_)) {
            for (std::size_t k = 0; k < 3 && is_folded_[f]; ++k) {
                const std::uint32_t v = piece_.faces[f][k];
                if (v < piece_.n_own && can_move_[v] && move(v)) {
                    moves.emplace_back(first_vertex + v, piece_.centre + piece_.positions[v]);
                }
            }
        }
        std::erase_if(folded_, [&](std::uint32_t f) { return !is_folded_[f]; });
        return moves;
    }

    [[nodiscard]] FoldedFace described(std::uint32_t f, const PlaceFrame& frame) const {
        const auto p = corners_of(f);
        double longest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 edge = p[(k + 1) % 3] - p[k];
            longest = std::max(longest, dot(edge, edge));
        }
        return {frame.origin + frame.cell_size * (piece_.centre + placed_[f].centre),
                frame.cell_size * std::sqrt(longest)};
    }

  private:
    [[nodiscard]] std::array<Vec3, 3> corners_of(std::uint32_t f) const {
        const LocalFace& t = piece_.faces[f];
        return {piece_.positions[t[0]], piece_.positions[t[1]], piece_.positions[t[2]]};
    }
    [[nodiscard]] Placed place_of(std::uint32_t f) const { return place(corners_of(f)); }

    void find_folded() {
        std::vector<std::uint32_t> faces;
        for (std::uint32_t f = 0; f < placed_.size(); ++f) {
            if (dot(placed_[f].normal, placed_[f].normal) > 0) faces.push_back(f);
        }
        // Nearly all have a sample within its spacing that faces as they do, which tells at once.
        std::vector<NearestSides> sides = nearest_sides(faces, spacing_);
        std::size_t n = 0;
        for (std::size_t i = 0; i < faces.size(); ++i) {
            if (std::sqrt(sides[i].front) > spacing_) faces[n++] = faces[i];
        }
        faces.resize(n);
        sides = nearest_sides(faces, reach_);
        is_folded_.resize(placed_.size());
        for (std::size_t i = 0; i < faces.size(); ++i) {
            if (!sides[i].is_folded(reach_, spacing_)) continue;
            is_folded_[faces[i]] = true;
            folded_.push_back(faces[i]);
        }
    }
    /// Of the samples within `reach` of each of these faces, and some more.
    [[nodiscard]] std::vector<NearestSides> nearest_sides(std::span<const std::uint32_t> faces,
                                                          double reach) const {
        std::vector<NearestSides> sides(faces.size());
        if (faces.empty()) return sides;
        std::vector<Vec3> centres;
        centres.reserve(faces.size());
        FloatBox box;
        for (const std::uint32_t f : faces) {
            centres.push_back(placed_[f].centre);
            box.extend(piece_.centre + placed_[f].centre);
        }
        const PointGrid grid(centres, reach / 2);
        samples_.for_each(box, reach, piece_.centre, [&](std::span<const WeightedPoint> points) {
            for (const WeightedPoint& point : points) {
                grid.for_each_near(as_vec3(point.position), reach, [&](std::uint32_t i) {
                    sides[i].add(placed_[faces[i]], point);
                });
            }
        });
        return sides;
    }

    /// Faces by vertex, and which vertices are inside the surface and the region.
    void find_corners() {
        start_.assign(piece_.positions.size() + 1, 0);
        for (const LocalFace& t : piece_.faces) {
            for (const std::uint32_t v : t) ++start_[v + 1];
        }
        for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
        faces_.resize(start_.back());
        std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
        can_move_.assign(piece_.n_own, true);
        for (std::uint32_t f = 0; f < piece_.faces.size(); ++f) {
            const LocalFace& t = piece_.faces[f];
            const bool is_inside =
                std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < piece_.n_own; });
            for (const std::uint32_t v : t) {
                faces_[next[v]++] = f;
                if (!is_inside && v < piece_.n_own) can_move_[v] = false;
            }
        }
        for_each_edge(piece_.faces, piece_.positions.size(),
                      [&](std::uint32_t low, std::span<const HalfEdge> group) {
                          if (group.size() == 2) return;
                          for (const std::uint32_t v : {low, group[0].other}) {
                              if (v < piece_.n_own) can_move_[v] = false;
                          }
                      });
    }

    [[nodiscard]] std::span<const std::uint32_t> faces_of(std::uint32_t v) const {
        return std::span(faces_).subspan(start_[v], start_[v + 1] - start_[v]);
    }

    /// Cells as long as the reach, by which samples are told to be near.
    [[nodiscard]] std::int64_t cell_of(double x) const {
        constexpr double kZero = 1 << 20;  // the cell of 0: truncation is right for what is above 0
        return static_cast<std::int64_t>(x / reach_ + kZero);
    }
    void add_cells(const FloatBox& box, CodeSet& cells) const {
        std::array<std::int64_t, 3> low;
        std::array<std::int64_t, 3> high;
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = cell_of(static_cast<double>(box.low[k]) - reach_);
            high[k] = cell_of(static_cast<double>(box.high[k]) + reach_);
            // A face that is longer than that is looked at around its middle.
            constexpr std::int64_t kMostCells = 16;
            const std::int64_t cut = std::max<std::int64_t>(0, (high[k] - low[k] - kMostCells) / 2);
            low[k] += cut;
            high[k] -= cut;
        }
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                for (std::int64_t z = low[2]; z <= high[2]; ++z) cells.add(cell_code({x, y, z}));
            }
        }
    }

    /// The samples around the corners of folded faces: all that a move can need.
    void gather_samples() {
        std::vector<std::uint32_t> near;
        for (const std::uint32_t f : folded_) {
            for (const std::uint32_t v : piece_.faces[f]) {
                const auto around = faces_of(v);
                near.insert(near.end(), around.begin(), around.end());
            }
        }
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        FloatBox all;
        CodeSet cells;
        for (const std::uint32_t f : near) {
            FloatBox box;
            for (const Vec3& p : corners_of(f)) box.extend(p);
            all.extend(box);
            add_cells(box, cells);
        }
        cells.finish();
        FloatBox in_mesh;
        in_mesh.extend(piece_.centre + Vec3{all.low[0], all.low[1], all.low[2]});
        in_mesh.extend(piece_.centre + Vec3{all.high[0], all.high[1], all.high[2]});
        samples_.for_each(
            in_mesh, reach_, piece_.centre, [&](std::span<const WeightedPoint> points) {
                for (const WeightedPoint& point : points) {
                    const Vec3 p = as_vec3(point.position);
                    if (cells.contains(cell_code({cell_of(p[0]), cell_of(p[1]), cell_of(p[2])}))) {
                        near_.push_back(point);
                    }
                }
            });
        std::vector<Vec3> places;
        places.reserve(near_.size());
        for (const WeightedPoint& point : near_) places.push_back(as_vec3(point.position));
        near_grid_.emplace(places, reach_ / 2);
    }

    [[nodiscard]] bool judge(const Placed& face) const {
        NearestSides sides;
        near_grid_->for_each_near(face.centre, reach_,
                                  [&](std::uint32_t i) { sides.add(face, near_[i]); });
        return sides.is_folded(reach_, spacing_);
    }

    bool move(std::uint32_t v) {
        const auto around = faces_of(v);
        Vec3 middle{};
        std::size_t n_before = 0;
        for (const std::uint32_t f : around) {
            for (const std::uint32_t w : piece_.faces[f]) {
                if (w != v) middle = middle + piece_.positions[w];
            }
            if (is_folded_[f]) ++n_before;
        }
        middle = (0.5 / static_cast<double>(around.size())) * middle;
        const Vec3 from = piece_.positions[v];
        std::vector<std::pair<Placed, bool>> after(around.size());
        for (const double step : kSteps) {
            const Vec3 shift = step * (middle - from);
            if (dot(shift, shift) > most_move_ * most_move_) continue;
            piece_.positions[v] = from + shift;
            std::size_t n_after = 0;
            bool is_safe = true;
            for (std::size_t i = 0; i < around.size() && is_safe; ++i) {
                const std::uint32_t f = around[i];
                after[i] = {place_of(f), false};
                const Placed& face = after[i].first;
                after[i].second = judge(face);
                if (after[i].second) ++n_after;
                is_safe = dot(face.normal, face.normal) > 0 &&
                          (is_folded_[f] || dot(face.normal, placed_[f].normal) > 0);
            }
            if (!is_safe || n_after >= n_before) continue;
            for (std::size_t i = 0; i < around.size(); ++i) {
                placed_[around[i]] = after[i].first;
                is_folded_[around[i]] = after[i].second;
            }
            return true;
        }
        piece_.positions[v] = from;
        return false;
    }

    MeshPiece piece_;
    const SampleRuns& samples_;
    double most_move_ = 0;
    double reach_;
    double spacing_;
    std::vector<Placed> placed_;
    std::vector<bool> is_folded_;
    std::vector<std::uint32_t> folded_;
    std::vector<std::uint32_t> start_;
    std::vector<std::uint32_t> faces_;
    std::vector<bool> can_move_;
    std::vector<WeightedPoint> near_;
    std::optional<PointGrid> near_grid_;  // of these
};

void move_vertices(ooc::Context& context, MeshStore& mesh, std::span<const Move> moves) {
    constexpr std::uint64_t kPiece = 1 << 12;
    ooc::Spool<StoredVertex> moved(context, "vertices");
    std::vector<StoredVertex> vertices;
    auto move = moves.begin();
    for (std::uint64_t first = 0; first < mesh.vertices.size(); first += kPiece) {
        vertices.resize(std::min(kPiece, mesh.vertices.size() - first));
        mesh.vertices.read(first, vertices);
        for (; move != moves.end() && move->first < first + vertices.size(); ++move) {
            vertices[move->first - first].vertex.position = move->second;
        }
        moved.append(vertices);
        context.check_stop();
    }
    mesh.vertices = std::move(moved);
}

bool is_own(const MeshPiece& piece, std::span<const std::uint64_t> vertices, std::uint32_t f) {
    const LocalFace& t = piece.faces[f];
    const auto first = std::min_element(t.begin(), t.end(), [&](std::uint32_t a, std::uint32_t b) {
        return vertices[a] < vertices[b];
    });
    return *first < piece.n_own;
}

}  // namespace

FoldedFaces unfold_faces(ooc::Context& context, MeshStore& mesh,
                         const ooc::Spool<FitSample>& samples,
                         std::span<const cluster::OctreeBox> boxes,
                         std::span<const std::uint64_t> first_cluster, double most_move,
                         const PlaceFrame& frame) {
    FoldedFaces folded;
    if (mesh.faces.empty() || samples.empty()) return folded;
    std::vector<Move> moves;
    {
        const ooc::Spool<Vec3> positions = positions_of(context, mesh);
        const MeshRegions regions(context, mesh, positions, boxes, first_cluster);
        const SampleRuns runs(context, samples, mesh.origin, mesh.vertices.size());
        const double reach = runs.spacing();
        const double spacing =
            reach * std::sqrt(static_cast<double>(mesh.vertices.size()) /
                              static_cast<double>(std::max<std::uint64_t>(1, runs.size())));
        const std::uint64_t bytes = regions.region_bytes(0) +
                                    kBytesPerFace * MeshRegions::kMostFaces +
                                    SampleRuns::kMostPoints * sizeof(WeightedPoint);
        const BlocksInFlight in_flight(context, "regions with folded faces", bytes);
        struct Work {
            std::vector<FoldedFace> faces;
            std::vector<Move> moves;
            std::uint64_t n_unfolded = 0;
        };
        in_flight.sweep<Work>(
            regions.size(),
            [&](std::uint64_t r, Work& work) {
                std::vector<std::uint64_t> vertices;
                Region region(regions.load(r, 0, positions, vertices), runs, reach, spacing);
                // A face belongs to the region of its first vertex.
                const auto n_own_faces = [&] {
                    return std::count_if(
                        region.folded().begin(), region.folded().end(),
                        [&](std::uint32_t f) { return is_own(region.piece(), vertices, f); });
                };
                work = {};
                const auto n_before = n_own_faces();
                if (most_move > 0)
                    work.moves = region.turn_back(regions.first_vertex(r), most_move);
                work.n_unfolded = static_cast<std::uint64_t>(n_before - n_own_faces());
                for (const std::uint32_t f : region.folded()) {
                    if (is_own(region.piece(), vertices, f)) {
                        work.faces.push_back(region.described(f, frame));
                    }
                }
            },
            [&](std::uint64_t, const Work& work) {
                for (const FoldedFace& face : work.faces) add_face(folded, face);
                folded.unfolded += work.n_unfolded;
                moves.insert(moves.end(), work.moves.begin(), work.moves.end());
            });
    }
    if (!moves.empty()) {
        // A vertex may have moved more than once: its last place counts.
        std::stable_sort(moves.begin(), moves.end(),
                         [](const Move& a, const Move& b) { return a.first < b.first; });
        move_vertices(context, mesh, moves);
    }
    return folded;
}

}  // namespace hewer::rsimp
