// SPDX-License-Identifier: MIT
#include "rsimp/lod_output.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "hewer/error.h"
#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/face_normals.h"
#include "rsimp/mesh_topology.h"
#include "rsimp/vertex_rank.h"
#include "streaming/vertex_cache_order.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kPiece = 1 << 14;   // vertices handed to a sink at once
constexpr std::uint64_t kWindow = 1 << 16;  // faces that are ordered together

std::uint16_t to_channel(float sum, float n) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(sum / n, 0.0F, 65535.0F)));
}

std::array<float, 3> unit(std::array<float, 3> n) {
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return {0, 0, 1};
    for (float& x : n) x /= length;
    return n;
}

/// In the order for a vertex cache; vertices keep their numbers.
void order_window(std::vector<std::array<std::uint32_t, 3>>& faces) {
    std::vector<std::uint32_t> vertices;
    for (const auto& t : faces) vertices.insert(vertices.end(), t.begin(), t.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (auto& t : faces) {
        for (std::uint32_t& v : t) {
            v = static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                           vertices.begin());
        }
    }
    std::vector<std::uint32_t> new_index(vertices.size());
    streaming::order_for_vertex_cache(faces, vertices.size(), new_index);
    std::vector<std::uint32_t> old(vertices.size());
    for (std::uint32_t v = 0; v < new_index.size(); ++v) old[new_index[v]] = vertices[v];
    for (auto& t : faces) {
        for (std::uint32_t& v : t) v = old[v];
    }
}

}  // namespace

LodOutput::LodOutput(ooc::Context& context, const Format& format, bool with_parents)
    : context_(context), format_(format), with_parents_(with_parents) {}

Vec3 LodOutput::to_model(const Vec3& origin, const Vec3& position) const {
    return format_.lattice.origin() +
           (format_.grid.cell_size(format_.lattice) * (origin + position));
}

void LodOutput::survey(const MeshStore& mesh, LodReport& report) const {
    report.triangles = mesh.faces.size();
    report.vertices = mesh.vertices.size();
    report.bounds = {};
    double farthest = 0;
    ooc::SpoolReader<StoredVertex> vertices(mesh.vertices);
    while (const StoredVertex* v = vertices.next()) {
        report.bounds.extend(to_model(mesh.origin, v->vertex.position));
        const auto& box = v->vertex.box;
        farthest =
            std::max(farthest, farthest_corner({box[0], box[1], box[2]}, {box[3], box[4], box[5]},
                                               v->vertex.position));
    }
    report.error_bound = farthest * format_.grid.cell_size(format_.lattice);
}

ooc::Spool<LodOutput::IndexFace> LodOutput::index_faces(const MeshStore& mesh) const {
    const VertexRank rank(context_, mesh.vertices);
    ooc::Spool<IndexFace> indexed(context_, "LOD triangles");
    context_.workers().in_order(
        (mesh.faces.size() + kWindow - 1) / kWindow, 2 * context_.n_threads(),
        [&](std::uint64_t w) {
            const std::uint64_t first = w * kWindow;
            std::vector<Face> faces(std::min(kWindow, mesh.faces.size() - first));
            mesh.faces.read(first, faces);
            std::vector<IndexFace> own;
            own.reserve(faces.size());
            for (const Face& f : faces) {
                own.push_back({rank.of(f[0]), rank.of(f[1]), rank.of(f[2])});
            }
            return own;
        },
        [&](std::uint64_t, const std::vector<IndexFace>& own) { indexed.append(own); });
    return indexed;
}

void LodOutput::write(const MeshStore& mesh, MeshSink& sink, LodReport& report) {
    if (mesh.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw InvalidArgument("the level of detail has more than 2^32 vertices; ask for fewer");
    }
    survey(mesh, report);
    const ooc::Spool<IndexFace> faces = index_faces(mesh);
    report.topology = count_topology(context_, faces, report.vertices);
    SinkHeader header;
    header.n_vertices = report.vertices;
    header.n_triangles = report.triangles;
    header.has_normals = format_.has_normals;
    header.has_colors = format_.has_colors;
    header.has_alpha = format_.has_alpha;
    header.bounds = report.bounds;
    header.has_double_positions = format_.has_double_positions;
    sink.begin(header);
    send_vertices(mesh, faces, sink);
    send_triangles(faces, sink);
    if (with_parents_) {
        before_ = std::move(last_);
        last_.clear();
        ooc::SpoolReader<StoredVertex> vertices(mesh.vertices);
        while (const StoredVertex* v = vertices.next()) last_.push_back(v->id);
    }
}

void LodOutput::send_vertices(const MeshStore& mesh, const ooc::Spool<IndexFace>& faces,
                              MeshSink& sink) {
    const auto missing = format_.has_normals
                             ? missing_normals(mesh, faces)
                             : std::unordered_map<std::uint32_t, std::array<float, 3>>{};
    const bool has_attributes = format_.has_normals || format_.has_colors;
    std::vector<StoredVertex> vertices;
    std::vector<cluster::CellAttributes> attributes;
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;
    std::vector<Rgba16> colors;
    for (std::uint64_t first = 0; first < mesh.vertices.size(); first += kPiece) {
        vertices.resize(std::min(kPiece, mesh.vertices.size() - first));
        mesh.vertices.read(first, vertices);
        positions.clear();
        normals.clear();
        colors.clear();
        for (const StoredVertex& v : vertices) {
            positions.push_back(to_model(mesh.origin, v.vertex.position));
            for (const double x : positions.back()) add_to_hash(std::bit_cast<std::uint64_t>(x));
        }
        if (has_attributes) {
            attributes.resize(vertices.size());
            mesh.attributes.read(first, attributes);
            for (std::size_t i = 0; i < attributes.size(); ++i) {
                const cluster::CellAttributes& a = attributes[i];
                if (format_.has_normals) {
                    const auto it = missing.find(static_cast<std::uint32_t>(first + i));
                    normals.push_back(unit(it == missing.end() ? a.normal : it->second));
                }
                if (format_.has_colors) {
                    const float n = std::max(a.n_colors, 1.0F);
                    colors.push_back({to_channel(a.color[0], n), to_channel(a.color[1], n),
                                      to_channel(a.color[2], n), to_channel(a.color[3], n)});
                }
            }
        }
        sink.add_vertices({positions, normals, colors});
        context_.check_stop();
    }
}

void LodOutput::send_triangles(const ooc::Spool<IndexFace>& faces, MeshSink& sink) {
    std::vector<Triangle> triangles;
    context_.workers().in_order(
        (faces.size() + kWindow - 1) / kWindow, 2 * context_.n_threads(),
        [&](std::uint64_t w) {
            const std::uint64_t first = w * kWindow;
            std::vector<IndexFace> own(std::min(kWindow, faces.size() - first));
            faces.read(first, own);
            order_window(own);
            context_.check_stop();
            return own;
        },
        [&](std::uint64_t, const std::vector<IndexFace>& own) {
            triangles.clear();
            for (const IndexFace& t : own) {
                triangles.push_back({t[0], t[1], t[2]});
                add_to_hash(t[0] | static_cast<std::uint64_t>(t[1]) << 32);
                add_to_hash(t[2]);
            }
            sink.add_triangles(triangles);
        });
}

LodParents LodOutput::parents(const std::vector<std::pair<VertexId, VertexId>>& merges) const {
    std::unordered_map<VertexId, VertexId> parent(merges.begin(), merges.end());
    LodParents result;
    result.reserve(before_.size());
    for (VertexId id : before_) {
        for (auto it = parent.find(id); it != parent.end(); it = parent.find(id)) id = it->second;
        const auto at = std::lower_bound(last_.begin(), last_.end(), id);
        result.push_back(at != last_.end() && *at == id
                             ? static_cast<std::uint64_t>(at - last_.begin())
                             : std::numeric_limits<std::uint64_t>::max());
    }
    return result;
}

}  // namespace hewer::rsimp
