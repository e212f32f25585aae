// SPDX-License-Identifier: MIT
#include "fidelity/pull_to_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "ooc/triangle_foot.h"
#include "ooc/vec3.h"

namespace hewer::fidelity {

namespace {

// Barycentric, of the foot: an edge may be split if the corner opposite has less than this.
constexpr double kNearEdge = 0.4;
// Cosine of how far a face may turn.
constexpr double kMostTurn = 0.1;
// Times the distance before: how far a flip may leave it.
constexpr double kNearer = 0.95;
constexpr double kNoFarther = 1.01;
// Times what is near enough: the height of a face that is too thin to be moved.
constexpr double kThin = 0.25;
// Times what is near enough: up to that corners move a little rather than that there are more.
constexpr double kNearly = 1.4;

using Weights = std::array<double, 3>;
using Faces = std::vector<std::size_t>;

// Faces that are looked at together: few enough to be near each other.
constexpr std::size_t kGroup = 64;

/// Where a pull begins.
struct Host {
    std::size_t face = 0;
    Weights weights{};
    double squared_distance = std::numeric_limits<double>::infinity();
};

/// Faces, and those in their place.
struct Change {
    bool is_edge = false;  // that is split
    Faces before;
    std::vector<Triangle> after;
    double turn = -1;  // least cosine between a face before and those in its place
};

class Puller {
  public:
    explicit Puller(Mesh& mesh) : mesh_(mesh), is_changed_(mesh.triangles.size()) {}

    PullReport pull(std::span<const Pull> pulls) {
        const std::vector<Host> hosts = find_hosts(pulls);
        find_faces_around(hosts);
        PullReport report;
        const std::uint64_t n_vertices = mesh_.positions.size();
        const std::uint64_t n_triangles = mesh_.triangles.size();
        for (std::size_t i = 0; i < pulls.size(); ++i) {
            if (pull(hosts[i], pulls[i])) ++report.n_done;
        }
        report.vertices = mesh_.positions.size() - n_vertices;
        report.triangles = mesh_.triangles.size() - n_triangles;
        report.border_edges = n_border_splits_;
        report.faces = faces_at_hand(hosts);
        report.boxes = std::move(boxes_);
        return report;
    }

  private:
    [[nodiscard]] const Vec3& position(std::uint64_t v) const { return mesh_.positions[v]; }

    [[nodiscard]] std::vector<Host> find_hosts(std::span<const Pull> pulls) const {
        std::vector<Host> hosts(pulls.size());
        for (std::size_t first = 0; first < mesh_.triangles.size(); first += kGroup) {
            const std::size_t end = std::min(first + kGroup, mesh_.triangles.size());
            Bounds box;
            for (std::size_t f = first; f < end; ++f) {
                for (const std::uint64_t v : mesh_.triangles[f]) box.extend(position(v));
            }
            for (std::size_t i = 0; i < pulls.size(); ++i) {
                if (squared_distance(box, pulls[i].from) >= hosts[i].squared_distance) continue;
                for (std::size_t f = first; f < end; ++f) look_at(f, pulls[i].from, hosts[i]);
            }
        }
        return hosts;
    }
    void look_at(std::size_t f, const Vec3& p, Host& host) const {
        const Triangle& t = mesh_.triangles[f];
        const Vec3& a = position(t[0]);
        const Vec3& b = position(t[1]);
        const Vec3& c = position(t[2]);
        const Weights w = foot_of(p, a, b, c).weights;
        const Vec3 way = p - (w[0] * a + w[1] * b + w[2] * c);
        if (dot(way, way) < host.squared_distance) host = {f, w, dot(way, way)};
    }

    [[nodiscard]] std::vector<std::uint64_t> faces_at_hand(std::span<const Host> hosts) const {
        std::vector<std::uint64_t> faces;
        for (const Host& host : hosts) faces.push_back(host.face);
        for (std::size_t f = 0; f < is_changed_.size(); ++f) {
            if (is_changed_[f]) faces.push_back(f);
        }
        for (std::size_t f = is_changed_.size(); f < mesh_.triangles.size(); ++f) {
            faces.push_back(f);
        }
        std::sort(faces.begin(), faces.end());
        faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
        return faces;
    }

    /// Faces by vertex, for the corners of hosts.
    void find_faces_around(std::span<const Host> hosts) {
        std::vector<bool> is_corner(mesh_.positions.size());
        for (const Host& host : hosts) {
            for (const std::uint64_t v : mesh_.triangles[host.face]) is_corner[v] = true;
        }
        for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
            for (const std::uint64_t v : mesh_.triangles[f]) {
                if (is_corner[v]) around_.emplace_back(v, f);
            }
        }
        std::sort(around_.begin(), around_.end());
    }
    /// Of a corner of a host; empty if one has changed.
    [[nodiscard]] Faces faces_of(std::uint64_t v) const {
        Faces faces;
        auto at = std::lower_bound(around_.begin(), around_.end(), std::pair{v, std::size_t{0}});
        for (; at != around_.end() && at->first == v; ++at) {
            if (is_changed_[at->second]) return {};
            faces.push_back(at->second);
        }
        return faces;
    }
    [[nodiscard]] Faces faces_of(std::uint64_t a, std::uint64_t b) const {
        Faces faces = faces_of(a);
        std::erase_if(faces, [&](std::size_t f) {
            const Triangle& t = mesh_.triangles[f];
            return std::find(t.begin(), t.end(), b) == t.end();
        });
        return faces;
    }

    [[nodiscard]] Bounds box_of(const Faces& faces) const {
        Bounds box;
        for (const std::size_t f : faces) {
            for (const std::uint64_t v : mesh_.triangles[f]) box.extend(position(v));
        }
        return box;
    }
    [[nodiscard]] Vec3 normal_of(const Triangle& t) const {
        return cross(position(t[1]) - position(t[0]), position(t[2]) - position(t[0]));
    }
    /// From the normal of a face to that of another one; -1: no area.
    [[nodiscard]] double cosine(const Vec3& before, const Triangle& t) const {
        const Vec3 after = normal_of(t);
        const double lengths = dot(before, before) * dot(after, after);
        return lengths > 0 ? dot(before, after) / std::sqrt(lengths) : -1;
    }

    bool pull(const Host& host, const Pull& pull) {
        if (!std::isfinite(host.squared_distance) || is_changed_[host.face]) return false;
        const Vec3 way = pull.to - foot_of_host(host);
        const double distance = std::sqrt(dot(way, way));
        // Already there: what was wrong has gone with what other pulls did.
        if (distance <= pull.near) return false;
        const Vec3 least = (1 - pull.near / distance) * way;
        if (pull.by == Pull::By::Corners) return nudge(host, least);
        if (pull.by == Pull::By::Flip && flip(host, pull.to, pull.near)) return true;
        const bool by_vertex = pull.by == Pull::By::Vertex || distance > kNearly * pull.near;
        if (by_vertex ? split(host, pull.to) || nudge(host, least)
                      : nudge(host, least) || split(host, pull.to)) {
            return true;
        }
        return pull.by != Pull::By::Flip && flip(host, pull.to, pull.near);
    }
    [[nodiscard]] Vec3 foot_of_host(const Host& host) const {
        const Triangle& t = mesh_.triangles[host.face];
        Vec3 foot{};
        for (std::size_t c = 0; c < 3; ++c) foot = foot + host.weights[c] * position(t[c]);
        return foot;
    }

    /// Moves the corners as little as moves the foot by that.
    bool nudge(const Host& host, const Vec3& by) {
        const Triangle t = mesh_.triangles[host.face];
        Faces faces;
        double squares = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Faces around = faces_of(t[c]);
            if (around.empty()) return false;
            faces.insert(faces.end(), around.begin(), around.end());
            squares += host.weights[c] * host.weights[c];
        }
        std::sort(faces.begin(), faces.end());
        faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
        std::vector<Vec3> normals;
        for (const std::size_t f : faces) normals.push_back(normal_of(mesh_.triangles[f]));
        Bounds box = box_of(faces);
        const Vec3 way = (1 / squares) * by;
        std::array<Vec3, 3> before{};
        for (std::size_t c = 0; c < 3; ++c) {
            before[c] = position(t[c]);
            mesh_.positions[t[c]] = before[c] + host.weights[c] * way;
        }
        for (std::size_t i = 0; i < faces.size(); ++i) {
            if (cosine(normals[i], mesh_.triangles[faces[i]]) > kMostTurn) continue;
            for (std::size_t c = 0; c < 3; ++c) mesh_.positions[t[c]] = before[c];
            return false;
        }
        for (const std::size_t f : faces) is_changed_[f] = true;
        box.extend(box_of(faces));
        boxes_.push_back(box);
        return true;
    }

    bool split(const Host& host, const Vec3& to) {
        const Triangle t = mesh_.triangles[host.face];
        const std::uint64_t v = add_vertex(t, host.weights, to);
        Change best;
        const auto offer = [&](Change&& change) {
            if (change.turn > std::max(best.turn, kMostTurn)) best = std::move(change);
        };
        offer(split_face(host.face, v));
        for (std::size_t c = 0; c < 3; ++c) {
            if (host.weights[c] < kNearEdge) offer(split_edge(t[(c + 1) % 3], t[(c + 2) % 3], v));
        }
        if (best.turn < 0) {
            remove_last_vertex();
            return false;
        }
        carry_out(best);
        return true;
    }

    /// Turns an edge of the host between the two faces beside it, so that they come nearer; or, if
    /// the host is too thin to be moved, so that it is gone.
    bool flip(const Host& host, const Vec3& to, double near) {
        const Triangle t = mesh_.triangles[host.face];
        const double most = is_thin(t, kThin * near) ? kNoFarther : kNearer;
        Change best;
        for (std::size_t c = 0; c < 3; ++c) {
            Change change = flipped(t[(c + 1) % 3], t[(c + 2) % 3], t[c]);
            if (change.turn <= std::max(best.turn, kMostTurn)) continue;
            double before = std::numeric_limits<double>::infinity();
            for (const std::size_t f : change.before) {
                before = std::min(before, distance_to(mesh_.triangles[f], to));
            }
            if (std::any_of(change.after.begin(), change.after.end(), [&](const Triangle& f) {
                    return distance_to(f, to) <= most * before;
                })) {
                best = std::move(change);
            }
        }
        if (best.turn < 0) return false;
        carry_out(best);
        return true;
    }
    [[nodiscard]] double distance_to(const Triangle& t, const Vec3& p) const {
        return std::sqrt(squared_distance(p, position(t[0]), position(t[1]), position(t[2])));
    }
    [[nodiscard]] bool is_thin(const Triangle& t, double height) const {
        double longest = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 edge = position(t[(c + 1) % 3]) - position(t[c]);
            longest = std::max(longest, dot(edge, edge));
        }
        const Vec3 n = normal_of(t);
        return dot(n, n) <= height * height * longest;
    }
    /// Of the edge from a to b of a face whose third corner is c. Turns count from what both faces
    /// are together: a thin one has no direction.
    [[nodiscard]] Change flipped(std::uint64_t a, std::uint64_t b, std::uint64_t c) const {
        Change change{false, faces_of(a, b), {}, -1};
        if (change.before.size() != 2) return change;
        Vec3 together{};
        std::uint64_t d = c;
        for (const std::size_t f : change.before) {
            together = together + normal_of(mesh_.triangles[f]);
            for (const std::uint64_t v : mesh_.triangles[f]) {
                if (v != a && v != b && v != c) d = v;
            }
        }
        // Both on one side, or an edge from c to d that is there already.
        const Faces around = faces_of(c);
        if (d == c || around.empty() || !faces_of(c, d).empty()) return change;
        change.after = {{a, d, c}, {d, b, c}};
        change.turn = 1;
        for (const Triangle& after : change.after) {
            change.turn = std::min(change.turn, cosine(together, after));
        }
        return change;
    }

    [[nodiscard]] Change split_face(std::size_t face, std::uint64_t v) const {
        Change change{false, {face}, {}, 1};
        const Vec3 before = normal_of(mesh_.triangles[face]);
        for (std::size_t c = 0; c < 3; ++c) add(change, before, face, c, v);
        return change;
    }
    [[nodiscard]] Change split_edge(std::uint64_t a, std::uint64_t b, std::uint64_t v) const {
        Change change{true, faces_of(a, b), {}, 1};
        for (const std::size_t f : change.before) {
            const Triangle& t = mesh_.triangles[f];
            const Vec3 before = normal_of(t);
            for (std::size_t c = 0; c < 3; ++c) {
                if (t[c] == a || t[c] == b) add(change, before, f, c, v);
            }
        }
        if (change.before.empty()) change.turn = -1;
        return change;
    }
    /// One more face: `f` with v in the place of its corner c.
    void add(Change& change, const Vec3& before, std::size_t f, std::size_t c,
             std::uint64_t v) const {
        Triangle t = mesh_.triangles[f];
        t[c] = v;
        change.turn = std::min(change.turn, cosine(before, t));
        change.after.push_back(t);
    }
    void carry_out(const Change& change) {
        const std::size_t n = change.before.size();
        Bounds box = box_of(change.before);
        for (const Triangle& t : change.after) {
            for (const std::uint64_t v : t) box.extend(position(v));
        }
        boxes_.push_back(box);
        for (std::size_t i = 0; i < n; ++i) {
            is_changed_[change.before[i]] = true;
            mesh_.triangles[change.before[i]] = change.after[i];
        }
        mesh_.triangles.insert(mesh_.triangles.end(),
                               change.after.begin() + static_cast<std::ptrdiff_t>(n),
                               change.after.end());
        if (change.is_edge && n == 1) ++n_border_splits_;
    }

    std::uint64_t add_vertex(const Triangle& t, const Weights& weights, const Vec3& to) {
        mesh_.positions.push_back(to);
        if (!mesh_.normals.empty()) {
            Vec3 sum{};
            for (std::size_t c = 0; c < 3; ++c) {
                const std::array<float, 3>& n = mesh_.normals[t[c]];
                for (std::size_t k = 0; k < 3; ++k) {
                    sum[k] += weights[c] * static_cast<double>(n[k]);
                }
            }
            const double length = std::sqrt(dot(sum, sum));
            std::array<float, 3> normal{};
            for (std::size_t k = 0; k < 3 && length > 0; ++k) {
                normal[k] = static_cast<float>(sum[k] / length);
            }
            mesh_.normals.push_back(normal);
        }
        if (!mesh_.colors.empty()) {
            Rgba16 color{};
            for (std::size_t k = 0; k < color.size(); ++k) {
                double sum = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    sum += weights[c] * static_cast<double>(mesh_.colors[t[c]][k]);
                }
                color[k] = static_cast<std::uint16_t>(std::clamp(std::lround(sum), 0L, 65535L));
            }
            mesh_.colors.push_back(color);
        }
        return mesh_.positions.size() - 1;
    }
    void remove_last_vertex() {
        mesh_.positions.pop_back();
        if (!mesh_.normals.empty()) mesh_.normals.pop_back();
        if (!mesh_.colors.empty()) mesh_.colors.pop_back();
    }

    Mesh& mesh_;
    std::vector<bool> is_changed_;                               // by face of before
    std::vector<std::pair<std::uint64_t, std::size_t>> around_;  // vertex, face
    std::uint64_t n_border_splits_ = 0;
    std::vector<Bounds> boxes_;
};

}  // namespace

PullReport pull_to_points(Mesh& mesh, std::span<const Pull> pulls) {
    if (mesh.triangles.empty() || pulls.empty()) return {};
    return Puller(mesh).pull(pulls);
}

}  // namespace hewer::fidelity
