// SPDX-License-Identifier: MIT
#include "rsimp/lod_output.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/lod_parents.h"
#include "streaming/topology_counter.h"
#include "streaming/vertex_cache_order.h"

namespace hewer::rsimp {

namespace {

constexpr std::uint64_t kPiece = 1 << 13;  // vertices, and triangles, handed to a sink at once

std::uint64_t n_pieces(std::uint64_t n, std::uint64_t piece) {
    return (n + piece - 1) / piece;
}

std::uint16_t to_channel(float sum, float n) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(sum / n, 0.0F, 65535.0F)));
}

std::uint16_t to_channel(double share) {
    return static_cast<std::uint16_t>(std::lround(65535 * std::clamp(share, 0.0, 1.0)));
}

/// +z where there is no direction.
std::array<float, 3> unit(const Vec3& n) {
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return {0, 0, 1};
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length),
            static_cast<float>(n[2] / length)};
}

Vec3 to_double(const std::array<float, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

/// Vertices as they go out, bar the normals that come from faces.
struct LodOutput::VertexPiece {
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;
    std::vector<Rgba16> colors;
};

/// A window as it goes out.
struct LodOutput::FacePiece {
    FaceWindow window;  // faces in drawing order
    streaming::WindowTopology topology;
    std::vector<Vec3> positions;  // of its vertices, in model units, for sinks that take points
};

LodOutput::LodOutput(ooc::Context& context, const Format& format, bool with_parents,
                     std::uint64_t window_faces)
    : context_(context),
      format_(format),
      with_parents_(with_parents),
      window_faces_(window_faces) {}

Vec3 LodOutput::to_model(const Vec3& origin, const Vec3& position) const {
    return format_.lattice.origin() +
           (format_.grid.cell_size(format_.lattice) * (origin + position));
}

void LodOutput::write(const MeshStore& mesh, MeshSink& sink, LodReport& report) {
    report.vertices = mesh.vertices.size();
    report.triangles = mesh.faces.size();
    const std::uint64_t n_at_work = std::uint64_t{context_.n_threads()} + 1;
    const ooc::Reservation windows = context_.budget().reserve(
        "windows of the LOD", n_at_work * kWindowFaceBytes *
                                  std::max(kPiece, std::min(window_faces_, mesh.faces.size())));
    const IdIndex index = survey(mesh, report);
    SinkHeader header;
    header.n_vertices = report.vertices;
    header.n_triangles = report.triangles;
    header.has_normals = format_.has_normals;
    header.has_colors = format_.has_colors;
    header.has_alpha = format_.has_alpha;
    header.bounds = report.bounds;
    header.has_double_positions = format_.has_double_positions;
    // Without a fit only the bound is known, which is some ten times the error.
    constexpr double kShareOfBound = 0.1;
    header.error =
        report.fit.distance > 0 ? report.fit.distance : kShareOfBound * report.error_bound;
    const ooc::Reservation held =
        context_.budget().reserve("compressed output", sink.held_bytes(header));
    sink.begin(header);
    send_vertices(mesh, index, sink);
    send_faces(mesh, index, sink, report);
}

IdIndex LodOutput::survey(const MeshStore& mesh, LodReport& report) {
    struct Piece {
        std::vector<VertexId> ids;
        Bounds bounds;
        double farthest = 0;
    };
    const std::uint64_t n = mesh.vertices.size();
    IdIndex index(context_, n > 0 ? mesh.vertices.at(0).id : 0,
                  n > 0 ? mesh.vertices.at(n - 1).id : 0);
    if (with_parents_) {
        before_ = std::move(last_);
        last_ = ooc::Spool<VertexId>(context_, "vertex ids of an LOD");
    }
    report.bounds = {};
    double farthest = 0;
    context_.workers().in_order(
        n_pieces(n, kPiece), context_.n_threads() + 1,
        [&](std::uint64_t i) {
            std::vector<StoredVertex> vertices(std::min(kPiece, n - i * kPiece));
            mesh.vertices.read(i * kPiece, vertices);
            Piece piece;
            piece.ids.reserve(vertices.size());
            for (const StoredVertex& v : vertices) {
                const auto& box = v.vertex.box;
                const Vec3 low{static_cast<double>(box[0]), static_cast<double>(box[1]),
                               static_cast<double>(box[2])};
                const Vec3 high{static_cast<double>(box[3]), static_cast<double>(box[4]),
                                static_cast<double>(box[5])};
                piece.ids.push_back(v.id);
                piece.bounds.extend(to_model(mesh.origin, v.vertex.position));
                piece.farthest =
                    std::max(piece.farthest, farthest_corner(low, high, v.vertex.position));
            }
            return piece;
        },
        [&](std::uint64_t, const Piece& piece) {
            for (const VertexId id : piece.ids) index.append(id);
            if (with_parents_) last_.append(piece.ids);
            report.bounds.extend(piece.bounds);
            farthest = std::max(farthest, piece.farthest);
            context_.check_stop();
        });
    report.error_bound = farthest * format_.grid.cell_size(format_.lattice);
    return index;
}

LodOutput::VertexPiece LodOutput::make_vertices(const MeshStore& mesh, std::uint64_t first) const {
    VertexPiece piece;
    const std::uint64_t n = std::min(kPiece, mesh.vertices.size() - first);
    std::vector<StoredVertex> vertices(n);
    mesh.vertices.read(first, vertices);
    piece.positions.reserve(n);
    for (const StoredVertex& v : vertices) {
        piece.positions.push_back(to_model(mesh.origin, v.vertex.position));
    }
    if (!format_.has_normals && !format_.has_colors) return piece;
    VertexAttributes attributes;
    mesh.attributes.read(first, n, attributes);
    for (const cluster::CellAttributes& a : attributes.sums) {
        if (format_.has_normals) piece.normals.push_back(unit(to_double(a.normal)));
        if (format_.has_colors) {
            const float count = std::max(a.n_colors, 1.0F);
            piece.colors.push_back({to_channel(a.color[0], count), to_channel(a.color[1], count),
                                    to_channel(a.color[2], count), to_channel(a.color[3], count)});
        }
    }
    if (attributes.quadrics.empty()) return piece;
    for (std::size_t v = 0; v < n; ++v) {
        const cluster::AttributeQuadric& q = attributes.quadrics[v];
        const Vec3& x = vertices[v].vertex.position;
        if (!(q.weight > 0)) continue;
        if (format_.scales.color > 0) {
            for (std::size_t k = 0; k < 3; ++k) {
                piece.colors[v][k] = to_channel(q.value(k, x) / format_.scales.color);
            }
        }
        if (format_.scales.normal > 0 && is_usable_normal(attributes.sums[v].normal)) {
            piece.normals[v] = unit({q.value(3, x), q.value(4, x), q.value(5, x)});
        }
    }
    return piece;
}

void LodOutput::send_vertices(const MeshStore& mesh, const IdIndex& index, MeshSink& sink) {
    ooc::Spool<FaceNormal> from_faces;
    std::optional<ooc::SpoolReader<FaceNormal>> reader;
    if (format_.has_normals) {
        from_faces = missing_normals(context_, mesh, index, window_faces_);
        if (!from_faces.empty()) reader.emplace(from_faces);
    }
    const bool takes_points = sink.takes_points();
    context_.workers().in_order(
        n_pieces(mesh.vertices.size(), kPiece), context_.n_threads() + 1,
        [&](std::uint64_t i) { return make_vertices(mesh, i * kPiece); },
        [&](std::uint64_t i, VertexPiece& piece) {
            const std::uint64_t first = i * kPiece;
            const std::uint64_t end = first + piece.positions.size();
            while (reader && reader->peek() != nullptr && reader->peek()->vertex < end) {
                const std::uint64_t v = reader->peek()->vertex;
                Vec3 sum{};
                while (reader->peek() != nullptr && reader->peek()->vertex == v) {
                    sum = sum + reader->next()->sum;
                }
                piece.normals[v - first] = unit(sum);
            }
            for (const Vec3& p : piece.positions) hash_.add(p);
            if (!takes_points) sink.add_vertices({piece.positions, piece.normals, piece.colors});
            context_.check_stop();
        });
}

LodOutput::FacePiece LodOutput::make_faces(const MeshStore& mesh, const IdIndex& index,
                                           std::uint64_t window, bool with_points) const {
    FacePiece piece;
    const std::uint64_t first = window * window_faces_;
    piece.window =
        load_window(mesh, index, first, std::min(first + window_faces_, mesh.faces.size()));
    piece.topology = streaming::count_window(piece.window);
    streaming::order_for_vertex_cache(piece.window.faces, piece.window.vertices.size());
    if (with_points) {
        piece.positions = read_positions(mesh, piece.window.vertices);
        for (Vec3& p : piece.positions) p = to_model(mesh.origin, p);
    }
    return piece;
}

void LodOutput::send_faces(const MeshStore& mesh, const IdIndex& index, MeshSink& sink,
                           LodReport& report) {
    streaming::TopologyCounter topology(context_, report.vertices, context_.sort_bytes());
    const bool takes_points = sink.takes_points();
    context_.workers().in_order(
        n_pieces(mesh.faces.size(), window_faces_), context_.n_threads() + 1,
        [&](std::uint64_t w) { return make_faces(mesh, index, w, takes_points); },
        [&](std::uint64_t, const FacePiece& piece) {
            topology.add(piece.window, piece.topology);
            send_window(piece, sink);
            context_.check_stop();
        });
    report.topology = topology.finish();
}

void LodOutput::send_window(const FacePiece& piece, MeshSink& sink) {
    const std::vector<std::uint64_t>& vertices = piece.window.vertices;
    const auto& faces = piece.window.faces;
    std::vector<Triangle> triangles;
    std::vector<std::array<Vec3, 3>> points;
    for (std::size_t first = 0; first < faces.size(); first += kPiece) {
        const auto part = std::span(faces).subspan(first, std::min(kPiece, faces.size() - first));
        triangles.clear();
        points.clear();
        for (const auto& f : part) {
            for (const std::uint32_t v : f) hash_.add(vertices[v]);
            if (piece.positions.empty()) {
                triangles.push_back({vertices[f[0]], vertices[f[1]], vertices[f[2]]});
            } else {
                points.push_back(
                    {piece.positions[f[0]], piece.positions[f[1]], piece.positions[f[2]]});
            }
        }
        if (piece.positions.empty()) {
            sink.add_triangles(triangles);
        } else {
            sink.add_points(points);
        }
    }
}

LodParents LodOutput::parents(std::span<const std::pair<VertexId, VertexId>> merges) const {
    return find_parents(context_, before_, merges, last_);
}

}  // namespace hewer::rsimp
