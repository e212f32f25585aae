// SPDX-License-Identifier: MIT
#include "rsimp/mesh_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ooc/parallel.h"
#include "rsimp/box_groups.h"
#include "rsimp/face_window.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kFacesPerRun = 64;
constexpr std::uint64_t kVerticesPerPiece = 1 << 12;

VertexId id_at(const MeshStore& mesh, std::uint64_t rank) {
    return mesh.vertices.size() > 0 ? mesh.vertices.at(rank).id : 0;
}

std::uint64_t n_runs(std::uint64_t n, std::uint64_t per_run) {
    return (n + per_run - 1) / per_run;
}

/// What was told of a vertex by its rank, until another one takes its place: faces that follow each
/// other share vertices.
class RecentRanks {
  public:
    /// make(rank), unless that is known from before.
    template <typename Make>
    std::uint32_t find(std::uint64_t rank, const Make& make) {
        Recent& recent = recent_[rank % recent_.size()];
        if (recent.rank != rank) recent = {rank, make(rank)};
        return recent.value;
    }

  private:
    struct Recent {
        std::uint64_t rank = ~std::uint64_t{0};
        std::uint32_t value = 0;
    };
    std::array<Recent, 512> recent_;
};

}  // namespace

MeshRegions::MeshRegions(ooc::Context& context, const MeshStore& mesh,
                         const ooc::Spool<Vec3>& positions,
                         std::span<const cluster::OctreeBox> boxes,
                         std::span<const std::uint64_t> first_cluster)
    : mesh_(mesh),
      index_(context, id_at(mesh, 0),
             id_at(mesh, std::max<std::uint64_t>(1, mesh.vertices.size()) - 1)),
      face_boxes_(context.budget(), "boxes of faces", n_runs(mesh.faces.size(), kFacesPerRun)) {
    cut(context, boxes, first_cluster);
    find_boxes_of_faces(context, positions);
}

void MeshRegions::cut(ooc::Context& context, std::span<const cluster::OctreeBox> boxes,
                      std::span<const std::uint64_t> first_cluster) {
    std::vector<std::uint64_t> counts(boxes.size());
    std::vector<FloatBox> boxes_of_vertices(boxes.size());
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
    first_octree_box_.push_back(0);
    const std::uint64_t most =
        std::clamp(mesh_.vertices.size() / 4, kMostVertices / 4, kMostVertices);
    const std::vector<std::size_t> groups = group_boxes(boxes, counts, most);
    for (std::size_t g = 0; g + 1 < groups.size(); ++g) {
        FloatBox box;
        std::uint64_t end = first_.back();
        for (std::size_t b = groups[g]; b < groups[g + 1]; ++b) {
            box.extend(boxes_of_vertices[b]);
            end += counts[b];
        }
        if (end == first_.back()) continue;
        boxes_.push_back(box);
        first_.push_back(end);
        first_octree_box_.push_back(groups[g + 1]);
    }
    first_octree_box_.back() = boxes.size();
}

void MeshRegions::find_boxes_of_faces(ooc::Context& context, const ooc::Spool<Vec3>& positions) {
    context.workers().for_ranges(
        face_boxes_.size(), 64, [&](std::uint64_t begin, std::uint64_t end) {
            const std::uint64_t first = begin * kFacesPerRun;
            const std::uint64_t last = std::min(end * kFacesPerRun, mesh_.faces.size());
            const FaceWindow window = load_window(mesh_, index_, first, last);
            const std::vector<Vec3> places = read_places(positions, window.vertices);
            for (std::uint64_t run = begin; run < end; ++run) {
                const std::uint64_t from = (run - begin) * kFacesPerRun;
                const std::uint64_t to = std::min(from + kFacesPerRun, window.faces.size());
                FloatBox box;
                for (std::uint64_t f = from; f < to; ++f) {
                    for (const std::uint32_t v : window.faces[f]) box.extend(places[v]);
                }
                face_boxes_.set(run, box);
            }
            context.check_stop();
        });
    face_boxes_.finish();
}

/// Counts whole runs.
std::uint64_t MeshRegions::faces_at_most(std::size_t region, double reach) const {
    std::uint64_t n = 0;
    face_boxes_.for_each_near(boxes_[region], reach, [&](std::uint64_t) { n += kFacesPerRun; });
    return n;
}

std::uint64_t MeshRegions::region_bytes(double reach, std::uint64_t more_per_face) const {
    std::uint64_t most = kFacesPerRun;
    for (std::size_t r = 0; r < size(); ++r) {
        const std::uint64_t n = faces_at_most(r, reach);
        if (n <= kMostFaces) most = std::max(most, n);
    }
    // A face, its corners and those of others, its part of vertices, of the tree and of the sums.
    constexpr std::uint64_t kBytesPerFace = 24 + 24 + 12 + 40 + 100 + 60;
    return most * (kBytesPerFace + more_per_face);
}

MeshPiece MeshRegions::load(std::size_t region, double reach, const ooc::Spool<Vec3>& positions,
                            std::vector<std::uint64_t>& vertices,
                            std::vector<VertexId>* own_ids) const {
    const FloatBox& box = boxes_[region];
    const std::uint64_t first_own = first_[region];
    const std::uint64_t n_own = first_[region + 1] - first_own;
    MeshPiece piece;
    piece.n_own = static_cast<std::uint32_t>(n_own);
    piece.centre = box.centre();
    vertices.resize(n_own);
    for (std::uint64_t i = 0; i < n_own; ++i) vertices[i] = first_own + i;

    if (own_ids != nullptr) own_ids->resize(n_own);
    std::vector<Face> corners;
    const bool is_small = faces_at_most(region, reach) <= kMostFaces;
    const auto read_run = [&](std::uint64_t run) {
        const std::uint64_t first = run * kFacesPerRun;
        const std::uint64_t n = std::min(kFacesPerRun, mesh_.faces.size() - first);
        corners.resize(corners.size() + n);
        mesh_.faces.read(first, std::span(corners).last(n));
    };
    if (is_small) face_boxes_.for_each_near(box, reach, read_run);
    std::vector<std::uint64_t> others;
    {
        RecentRanks met;
        const auto note = [&](std::uint64_t rank) {
            others.push_back(rank);
            return std::uint32_t{0};
        };
        for (Face& face : corners) {
            for (std::uint64_t& corner : face) {
                const VertexId id = std::exchange(corner, index_.rank(corner));
                if (corner - first_own >= n_own) {
                    (void)met.find(corner, note);
                } else if (own_ids != nullptr) {
                    (*own_ids)[corner - first_own] = id;
                }
            }
        }
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    vertices.insert(vertices.end(), others.begin(), others.end());
    piece.positions.resize(n_own);
    positions.read(first_own, piece.positions);
    const std::vector<Vec3> around = read_places(positions, others);
    piece.positions.insert(piece.positions.end(), around.begin(), around.end());

    RecentRanks located;
    const auto locate = [&](std::uint64_t rank) {
        const auto place = std::lower_bound(others.begin(), others.end(), rank) - others.begin();
        return static_cast<std::uint32_t>(n_own + static_cast<std::uint64_t>(place));
    };
    for (const Face& face : corners) {
        LocalFace local;
        FloatBox own;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t place = face[k] - first_own;
            local[k] =
                place < n_own ? static_cast<std::uint32_t>(place) : located.find(face[k], locate);
            own.extend(piece.positions[local[k]]);
        }
        const bool is_own = local[0] < n_own || local[1] < n_own || local[2] < n_own;
        if (is_own || box.meets(own, reach)) piece.faces.push_back(local);
    }
    for (Vec3& p : piece.positions) p = p - piece.centre;
    return piece;
}

ooc::Spool<Vec3> positions_of(ooc::Context& context, const MeshStore& mesh) {
    ooc::Spool<Vec3> positions(context, "positions of vertices");
    std::vector<StoredVertex> vertices;
    std::vector<Vec3> piece;
    for (std::uint64_t first = 0; first < mesh.vertices.size(); first += kVerticesPerPiece) {
        vertices.resize(std::min(kVerticesPerPiece, mesh.vertices.size() - first));
        mesh.vertices.read(first, vertices);
        piece.clear();
        for (const StoredVertex& v : vertices) piece.push_back(v.vertex.position);
        positions.append(piece);
    }
    return positions;
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
