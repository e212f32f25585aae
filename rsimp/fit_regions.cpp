// SPDX-License-Identifier: MIT
#include "rsimp/fit_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/parallel.h"
#include "rsimp/box_groups.h"
#include "rsimp/face_window.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kFacesPerRun = 512;
constexpr std::uint64_t kSamplesPerRun = 1024;
constexpr std::uint64_t kVerticesPerPiece = 1 << 12;
// More samples for each vertex would cost time and change next to nothing.
constexpr std::uint64_t kEnoughSamplesPerVertex = 24;

VertexId id_at(const MeshStore& mesh, std::uint64_t rank) {
    return mesh.vertices.size() > 0 ? mesh.vertices.at(rank).id : 0;
}

Point3f to_single(const Vec3& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

std::uint64_t n_runs(std::uint64_t n, std::uint64_t per_run) {
    return (n + per_run - 1) / per_run;
}

}  // namespace

FitRegions::Box FitRegions::empty_box() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

void FitRegions::Box::extend(const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], static_cast<float>(p[k]));
        high[k] = std::max(high[k], static_cast<float>(p[k]));
    }
}

bool FitRegions::Box::meets(const Box& other, double reach) const {
    const auto r = static_cast<float>(reach);
    for (std::size_t k = 0; k < 3; ++k) {
        if (low[k] - r > other.high[k] || other.low[k] > high[k] + r) return false;
    }
    return true;
}

void FitRegions::Box::extend(const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], other.low[k]);
        high[k] = std::max(high[k], other.high[k]);
    }
}

FitRegions::FitRegions(ooc::Context& context, const MeshStore& mesh,
                       const ooc::Spool<FitSample>& samples,
                       std::span<const cluster::OctreeBox> boxes,
                       std::span<const std::uint64_t> first_cluster)
    : mesh_(mesh),
      samples_(samples),
      index_(context, id_at(mesh, 0),
             id_at(mesh, std::max<std::uint64_t>(1, mesh.vertices.size()) - 1)),
      face_boxes_(context.budget(), "boxes of faces", n_runs(mesh.faces.size(), kFacesPerRun)),
      sample_boxes_(context.budget(), "boxes of samples", n_runs(samples.size(), kSamplesPerRun)) {
    cut(context, boxes, first_cluster);
    find_boxes_of_faces(context);
    find_boxes_of_samples(context);
}

void FitRegions::cut(ooc::Context& context, std::span<const cluster::OctreeBox> boxes,
                     std::span<const std::uint64_t> first_cluster) {
    std::vector<std::uint64_t> counts(boxes.size());
    std::vector<Box> boxes_of_vertices(boxes.size(), empty_box());
    std::vector<StoredVertex> piece;
    std::size_t at = 0;
    for (std::uint64_t first = 0; first < mesh_.vertices.size(); first += kVerticesPerPiece) {
        piece.resize(std::min(kVerticesPerPiece, mesh_.vertices.size() - first));
        mesh_.vertices.read(first, piece);
        for (const StoredVertex& v : piece) {
            index_.append(v.id);
            while (cluster_of(v.id) >= first_cluster[at + 1]) ++at;
            ++counts[at];
            boxes_of_vertices[at].extend(v.vertex.position);
        }
        context.check_stop();
    }
    first_.push_back(0);
    const std::vector<std::size_t> groups = group_boxes(boxes, counts, kMostVertices);
    for (std::size_t g = 0; g + 1 < groups.size(); ++g) {
        Box box = empty_box();
        std::uint64_t end = first_.back();
        for (std::size_t b = groups[g]; b < groups[g + 1]; ++b) {
            box.extend(boxes_of_vertices[b]);
            end += counts[b];
        }
        if (end == first_.back()) continue;
        boxes_.push_back(box);
        first_.push_back(end);
    }
}

void FitRegions::find_boxes_of_faces(ooc::Context& context) {
    context.workers().for_ranges(
        face_boxes_.size(), 16, [&](std::uint64_t begin, std::uint64_t end) {
            const std::uint64_t first = begin * kFacesPerRun;
            const std::uint64_t last = std::min(end * kFacesPerRun, mesh_.faces.size());
            const FaceWindow window = load_window(mesh_, index_, first, last);
            const std::vector<Vec3> positions = read_positions(mesh_, window.vertices);
            for (std::uint64_t run = begin; run < end; ++run) face_boxes_[run] = empty_box();
            for (std::size_t f = 0; f < window.faces.size(); ++f) {
                Box& box = face_boxes_[begin + f / kFacesPerRun];
                for (const std::uint32_t v : window.faces[f]) box.extend(positions[v]);
            }
            context.check_stop();
        });
}

void FitRegions::find_boxes_of_samples(ooc::Context& context) {
    std::vector<FitSample> run(kSamplesPerRun);
    double area = 0;
    for (std::uint64_t r = 0; r < sample_boxes_.size(); ++r) {
        const std::uint64_t first = r * kSamplesPerRun;
        const std::span<FitSample> samples(run.data(),
                                           std::min(kSamplesPerRun, samples_.size() - first));
        samples_.read(first, samples);
        Box& box = sample_boxes_[r] = empty_box();
        for (const FitSample& sample : samples) {
            box.extend(sample.position() - mesh_.origin);
            area += static_cast<double>(sample.area());
        }
        context.check_stop();
    }
    const std::uint64_t n = std::max<std::uint64_t>(1, mesh_.vertices.size());
    const std::uint64_t enough = kEnoughSamplesPerVertex * n;
    spacing_ = std::sqrt(area / static_cast<double>(n));
    stride_ = std::max<std::uint64_t>(1, (samples_.size() + enough / 2) / enough);
}

/// Counts whole runs.
std::uint64_t FitRegions::faces_at_most(std::size_t region, double reach) const {
    std::uint64_t n = 0;
    for (const Box& box : face_boxes_) n += boxes_[region].meets(box, reach) ? kFacesPerRun : 0;
    return n;
}

std::uint64_t FitRegions::region_bytes(double reach) const {
    std::uint64_t most = kFacesPerRun;
    for (std::size_t r = 0; r < size(); ++r) {
        const std::uint64_t n = faces_at_most(r, reach);
        if (n <= kMostFaces) most = std::max(most, n);
    }
    // A face, its corners and those of others, its part of vertices, of the tree and of the sums.
    constexpr std::uint64_t kBytesPerFace = 24 + 24 + 12 + 40 + 100 + 60;
    return most * kBytesPerFace;
}

FitPiece FitRegions::load(std::size_t region, double reach, const ooc::Spool<Vec3>& positions,
                          std::vector<std::uint64_t>& vertices) const {
    const Box& box = boxes_[region];
    const std::uint64_t first_own = first_[region];
    const std::uint64_t n_own = first_[region + 1] - first_own;
    FitPiece piece;
    piece.n_own = static_cast<std::uint32_t>(n_own);
    for (std::size_t k = 0; k < 3; ++k) {
        piece.centre[k] =
            0.5 * (static_cast<double>(box.low[k]) + static_cast<double>(box.high[k]));
    }
    vertices.resize(n_own);
    for (std::uint64_t i = 0; i < n_own; ++i) vertices[i] = first_own + i;

    std::vector<Face> corners;
    const bool is_small = faces_at_most(region, reach) <= kMostFaces;
    for (std::uint64_t run = 0; is_small && run < face_boxes_.size(); ++run) {
        if (!box.meets(face_boxes_[run], reach)) continue;
        const std::uint64_t first = run * kFacesPerRun;
        const std::uint64_t n = std::min(kFacesPerRun, mesh_.faces.size() - first);
        corners.resize(corners.size() + n);
        mesh_.faces.read(first, std::span(corners).last(n));
    }
    std::vector<std::uint64_t> others;
    for (Face& face : corners) {
        for (std::uint64_t& corner : face) {
            corner = index_.rank(corner);
            if (corner - first_own >= n_own) others.push_back(corner);
        }
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    vertices.insert(vertices.end(), others.begin(), others.end());
    piece.positions.resize(n_own);
    positions.read(first_own, piece.positions);
    const std::vector<Vec3> around = read_places(positions, others);
    piece.positions.insert(piece.positions.end(), around.begin(), around.end());

    for (const Face& face : corners) {
        LocalFace local;
        Box own = empty_box();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t place = face[k] - first_own;
            local[k] = static_cast<std::uint32_t>(
                place < n_own
                    ? place
                    : n_own + static_cast<std::uint64_t>(
                                  std::lower_bound(others.begin(), others.end(), face[k]) -
                                  others.begin()));
            own.extend(piece.positions[local[k]]);
        }
        const bool is_own = local[0] < n_own || local[1] < n_own || local[2] < n_own;
        if (is_own || box.meets(own, reach)) piece.faces.push_back(local);
    }
    for (Vec3& p : piece.positions) p = p - piece.centre;
    return piece;
}

void FitRegions::for_samples(
    std::size_t region, double reach, const Vec3& centre,
    const std::function<void(std::span<const WeightedPoint>)>& visit) const {
    const Box& box = boxes_[region];
    std::vector<FitSample> samples;
    std::vector<WeightedPoint> points;
    for (std::uint64_t run = 0; run < sample_boxes_.size(); ++run) {
        if (!box.meets(sample_boxes_[run], reach)) continue;
        const std::uint64_t first = run * kSamplesPerRun;
        samples.resize(std::min(kSamplesPerRun, samples_.size() - first));
        samples_.read(first, samples);
        points.clear();
        for (std::uint64_t i = (stride_ - first % stride_) % stride_; i < samples.size();
             i += stride_) {
            const Vec3 p = samples[i].position() - mesh_.origin;
            Box place = empty_box();
            place.extend(p);
            if (!box.meets(place, reach)) continue;
            const Vec3 q = p - centre;
            points.push_back({to_single(q), samples[i].area(), to_single(samples[i].normal())});
        }
        if (!points.empty()) visit(points);
    }
}

std::vector<Vec3> read_places(const ooc::Spool<Vec3>& spool,
                              std::span<const std::uint64_t> places) {
    // Records between two wanted ones are read along up to this many.
    constexpr std::uint64_t kMostSkipped = 16;
    constexpr std::uint64_t kMostRead = 1024;
    std::vector<Vec3> result;
    result.reserve(places.size());
    std::vector<Vec3> records;
    for (std::size_t i = 0; i < places.size();) {
        std::size_t j = i + 1;
        while (j < places.size() && places[j] - places[j - 1] <= kMostSkipped &&
               places[j] - places[i] < kMostRead) {
            ++j;
        }
        records.resize(places[j - 1] - places[i] + 1);
        spool.read(places[i], records);
        for (std::size_t k = i; k < j; ++k) result.push_back(records[places[k] - places[i]]);
        i = j;
    }
    return result;
}

}  // namespace hewer::rsimp
