// SPDX-License-Identifier: MIT
#include "rsimp/edge_flips.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/triangle_foot.h"
#include "rsimp/half_edges.h"
#include "rsimp/shows_back.h"

namespace hewer::rsimp {

namespace {

// Of what the points of two faces had: the least that a flip takes off. Less is noise.
constexpr double kLeastGain = .02;
// Cosine of how far a new face may turn from the mean of the old ones.
constexpr double kMostTurn = .7;
// 1 is equilateral: worse than this only if it was worse before.
constexpr double kLeastShape = .1;
// Of the weight of all points of two faces: what the middle of the new edge gets.
constexpr double kMiddleShare = .2;
constexpr std::size_t kHalfEdgesPerSearch = 1024;

std::uint32_t next_in_face(std::uint32_t half_edge) {
    return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}
std::uint32_t before_in_face(std::uint32_t half_edge) {
    return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
}

double length_of(const Vec3& v) {
    return std::sqrt(dot(v, v));
}

/// A face that points may be nearest to.
class Candidate {
  public:
    Candidate(std::span<const Vec3> positions, const LocalFace& face)
        : a_(positions[face[0]]),
          b_(positions[face[1]]),
          c_(positions[face[2]]),
          normal_(cross(b_ - a_, c_ - a_)) {}

    [[nodiscard]] bool shows_back(const WeightedPoint& point) const {
        return rsimp::shows_back(normal_, as_vec3(point.normal));
    }
    /// Squared distance; infinite if the face shows the point its back.
    [[nodiscard]] double cost(const WeightedPoint& point) const {
        if (shows_back(point)) return std::numeric_limits<double>::infinity();
        return squared_distance(as_vec3(point.position), a_, b_, c_);
    }

  private:
    Vec3 a_;
    Vec3 b_;
    Vec3 c_;
    Vec3 normal_;
};

}  // namespace

EdgeFlips::EdgeFlips(const MeshPiece& piece)
    : positions_(piece.positions),
      n_own_(piece.n_own),
      faces_(piece.faces),
      across_(3 * faces_.size(), kNoIndex),
      is_fixed_(n_own_),
      first_(faces_.size(), kNoIndex) {
    find_neighbours();
    find_fixed_vertices();
}

std::uint32_t EdgeFlips::start_of(std::uint32_t half_edge) const {
    return faces_[half_edge / 3][half_edge % 3];
}

void EdgeFlips::find_neighbours() {
    for_each_edge(faces_, positions_.size(),
                  [&](std::uint32_t low, std::span<const HalfEdge> group) {
                      const bool is_inner =
                          group.size() == 2 && start_of(group[0].id) != start_of(group[1].id);
                      if (is_inner) {
                          across_[group[0].id] = group[1].id;
                          across_[group[1].id] = group[0].id;
                      } else if (group.size() > 1) {
                          for (const std::uint32_t v : {low, group[0].other}) {
                              if (v < n_own_) is_fixed_[v] = true;
                          }
                      }
                  });
}

/// Where a walk around a vertex does not meet all of its faces.
void EdgeFlips::find_fixed_vertices() {
    std::vector<std::uint32_t> n_faces(n_own_);
    std::vector<std::uint32_t> any(n_own_, kNoIndex);
    for (std::uint32_t h = 0; h < across_.size(); ++h) {
        const std::uint32_t v = start_of(h);
        if (v >= n_own_) continue;
        ++n_faces[v];
        // At a border the walk begins there.
        if (any[v] == kNoIndex || across_[h] == kNoIndex) any[v] = h;
    }
    for (std::uint32_t v = 0; v < n_own_; ++v) {
        if (any[v] == kNoIndex || is_fixed_[v]) continue;
        std::uint32_t n_met = 0;
        std::uint32_t h = any[v];
        do {
            ++n_met;
            h = across_[before_in_face(h)];
        } while (h != kNoIndex && h != any[v]);
        is_fixed_[v] = n_met != n_faces[v];
    }
}

bool EdgeFlips::take(const WeightedPoint& point, std::uint32_t nearest_face, float squared) {
    const LocalFace& face = faces_[nearest_face];
    if (std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return v >= n_own_; })) {
        return false;
    }
    if (Candidate(positions_, face).shows_back(point)) return false;
    next_.push_back(first_[nearest_face]);
    first_[nearest_face] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    face_.push_back(nearest_face);
    squared_.push_back(squared);
    return true;
}

/// `half_edge` starts at the vertex that might be a neighbour of `vertex`.
bool EdgeFlips::are_neighbours(std::uint32_t half_edge, std::uint32_t vertex) const {
    const auto is_met = [&](std::uint32_t h) {
        return start_of(next_in_face(h)) == vertex || start_of(before_in_face(h)) == vertex;
    };
    std::uint32_t h = half_edge;
    do {
        if (is_met(h)) return true;
        h = across_[before_in_face(h)];
    } while (h != kNoIndex && h != half_edge);
    if (h == half_edge) return false;
    for (h = across_[half_edge]; h != kNoIndex; h = across_[h]) {
        h = next_in_face(h);
        if (is_met(h)) return true;
    }
    return false;
}

/// False where an edge must stay for the topology's sake.
bool EdgeFlips::describe(std::uint32_t half_edge, Flip& flip) const {
    const std::uint32_t other = across_[half_edge];
    if (other == kNoIndex) return false;
    flip.f = half_edge / 3;
    flip.g = other / 3;
    const std::uint32_t a = start_of(half_edge);
    const std::uint32_t b = start_of(other);
    const std::uint32_t c = start_of(before_in_face(half_edge));
    const std::uint32_t d = start_of(before_in_face(other));
    for (const std::uint32_t v : {a, b, c, d}) {
        if (v >= n_own_ || is_fixed_[v]) return false;
    }
    if (c == d || are_neighbours(before_in_face(half_edge), d)) return false;
    flip.new_f = {c, a, d};
    flip.new_g = {d, b, c};
    flip.across_f = {across_[before_in_face(half_edge)], across_[next_in_face(other)]};
    flip.across_g = {across_[before_in_face(other)], across_[next_in_face(half_edge)]};
    return true;
}

bool EdgeFlips::keeps_shape(const Flip& flip) const {
    struct Form {
        Vec3 normal;  // twice the area long
        double doubled_area;
        double shape;
    };
    const auto form_of = [&](const LocalFace& t) {
        const Vec3 ab = positions_[t[1]] - positions_[t[0]];
        const Vec3 ac = positions_[t[2]] - positions_[t[0]];
        const Vec3 bc = positions_[t[2]] - positions_[t[1]];
        const Vec3 normal = cross(ab, ac);
        const double doubled_area = length_of(normal);
        const double squares = dot(ab, ab) + dot(ac, ac) + dot(bc, bc);
        return Form{normal, doubled_area,
                    squares > 0 ? 2 * std::sqrt(3.0) * doubled_area / squares : 0};
    };
    const Form f = form_of(faces_[flip.f]);
    const Form g = form_of(faces_[flip.g]);
    const Form new_f = form_of(flip.new_f);
    const Form new_g = form_of(flip.new_g);
    if (dot(f.normal, g.normal) < 0) return false;  // a fold, or an edge as sharp as one
    const Vec3 mean = f.normal + g.normal;
    const double least = kMostTurn * length_of(mean);
    for (const Form& form : {new_f, new_g}) {
        if (!(form.doubled_area > 0) || dot(form.normal, mean) < least * form.doubled_area) {
            return false;
        }
    }
    const double shape = std::min(new_f.shape, new_g.shape);
    return shape >= kLeastShape || shape >= std::min(f.shape, g.shape);
}

/// What the middle of the new edge is farther from the surface at its nearest point than that of
/// the old edge, in squares times the weight.
double EdgeFlips::cost_of_middles(const Flip& flip) const {
    struct Middle {
        Vec3 place;
        double nearest = std::numeric_limits<double>::infinity();
        double off = 0;

        void see(const WeightedPoint& point) {
            const Vec3 way = as_vec3(point.position) - place;
            const double squared = dot(way, way);
            if (squared >= nearest) return;
            nearest = squared;
            off = dot(way, as_vec3(point.normal));
        }
    };
    Middle before{0.5 * (positions_[flip.new_f[1]] + positions_[flip.new_g[1]])};
    Middle after{0.5 * (positions_[flip.new_f[0]] + positions_[flip.new_f[2]])};
    double weight = 0;
    for (const std::uint32_t face : {flip.f, flip.g}) {
        for (std::uint32_t i = first_[face]; i != kNoIndex; i = next_[i]) {
            before.see(points_[i]);
            after.see(points_[i]);
            weight += static_cast<double>(points_[i].weight);
        }
    }
    return kMiddleShare * weight * std::max(0.0, after.off * after.off - before.off * before.off);
}

/// 0 where the edge is to stay.
float EdgeFlips::gain_of(std::uint32_t half_edge) const {
    Flip flip;
    if (!describe(half_edge, flip) || !keeps_shape(flip)) return 0;
    double before = 0;
    for (const std::uint32_t face : {flip.f, flip.g}) {
        for (std::uint32_t i = first_[face]; i != kNoIndex; i = next_[i]) {
            before += static_cast<double>(points_[i].weight) * static_cast<double>(squared_[i]);
        }
    }
    const double most = (1 - kLeastGain) * before;
    double after = cost_of_middles(flip);
    const Candidate new_f(positions_, flip.new_f);
    const Candidate new_g(positions_, flip.new_g);
    for (const std::uint32_t face : {flip.f, flip.g}) {
        for (std::uint32_t i = first_[face]; i != kNoIndex; i = next_[i]) {
            if (!(after < most)) return 0;
            after += static_cast<double>(points_[i].weight) *
                     std::min(new_f.cost(points_[i]), new_g.cost(points_[i]));
        }
    }
    return after < most ? static_cast<float>(before - after) : 0;
}

/// The smaller half-edge stands for an edge.
void EdgeFlips::offer(std::uint32_t half_edge) {
    if (across_[half_edge] == kNoIndex) return;
    const auto [low, high] = std::minmax(half_edge, across_[half_edge]);
    heap_.erase(high);
    const float gain = gain_of(low);
    if (gain > 0) {
        heap_.set(low, -gain);
    } else {
        heap_.erase(low);
    }
}

void EdgeFlips::carry_out(const Flip& flip) {
    ++n_flips_;
    at_hand_.clear();
    for (const std::uint32_t face : {flip.f, flip.g}) {
        for (std::uint32_t k = 0; k < 3; ++k) {
            heap_.erase(3 * face + k);
            const std::uint32_t other = across_[3 * face + k];
            if (other != kNoIndex) heap_.erase(other);
        }
        for (std::uint32_t i = first_[face]; i != kNoIndex; i = next_[i]) at_hand_.push_back(i);
        first_[face] = kNoIndex;
    }
    faces_[flip.f] = flip.new_f;
    faces_[flip.g] = flip.new_g;
    const auto join = [&](std::uint32_t half_edge, std::uint32_t other) {
        across_[half_edge] = other;
        if (other != kNoIndex) across_[other] = half_edge;
    };
    for (std::uint32_t k = 0; k < 2; ++k) {
        join(3 * flip.f + k, flip.across_f[k]);
        join(3 * flip.g + k, flip.across_g[k]);
    }
    join(3 * flip.f + 2, 3 * flip.g + 2);
    const Candidate new_f(positions_, flip.new_f);
    const Candidate new_g(positions_, flip.new_g);
    for (const std::uint32_t i : at_hand_) {
        const double to_f = new_f.cost(points_[i]);
        const double to_g = new_g.cost(points_[i]);
        face_[i] = to_f <= to_g ? flip.f : flip.g;
        squared_[i] = static_cast<float>(std::min(to_f, to_g));
        next_[i] = first_[face_[i]];
        first_[face_[i]] = i;
    }
    for (std::uint32_t k = 0; k < 3; ++k) offer(3 * flip.f + k);
    for (std::uint32_t k = 0; k < 2; ++k) offer(3 * flip.g + k);
}

std::vector<EdgeFlips::Change> EdgeFlips::flip(ooc::Workers& workers, MeshPiece& piece) {
    std::vector<float> gains(across_.size());
    workers.for_ranges(across_.size(), kHalfEdgesPerSearch,
                       [&](std::size_t begin, std::size_t end) {
                           for (std::size_t i = begin; i < end; ++i) {
                               const auto h = static_cast<std::uint32_t>(i);
                               if (across_[h] != kNoIndex && h < across_[h]) gains[h] = gain_of(h);
                           }
                       });
    heap_ = IndexedHeap(gains.size());
    for (std::uint32_t h = 0; h < gains.size(); ++h) {
        if (gains[h] > 0) heap_.set(h, -gains[h]);
    }
    while (!heap_.empty()) {
        const std::uint32_t h = heap_.top();
        heap_.erase(h);
        // What surrounds the edge may have become neighbours by another flip.
        Flip flip;
        if (describe(h, flip) && gain_of(h) > 0) carry_out(flip);
    }
    std::vector<Change> changes;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        if (faces_[f] != piece.faces[f]) changes.push_back({piece.faces[f], faces_[f]});
    }
    piece.faces = faces_;
    return changes;
}

}  // namespace hewer::rsimp
