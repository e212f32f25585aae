// SPDX-License-Identifier: MIT
#include "rsimp/lod.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "ooc/parallel.h"
#include "ooc/vec3.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/manifold.h"
#include "streaming/vertex_cache_order.h"

namespace hewer::rsimp {

namespace {

// Lists of an LOD's vertices here, sums for missing normals, and what a sink may hold (STL: 12).
constexpr std::uint64_t kBytesPerVertex = 8 + 12 + 12;
constexpr std::uint64_t kPiece = 1 << 14;  // vertices and triangles handed to a sink at once

std::uint64_t count_components(std::span<const CellTriple> triangles, std::uint64_t n_vertices) {
    std::vector<std::uint32_t> label(n_vertices);
    std::iota(label.begin(), label.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (label[v] != v) v = label[v] = label[label[v]];
        return v;
    };
    std::uint64_t n = n_vertices;
    for (const CellTriple& t : triangles) {
        for (std::size_t i = 1; i < 3; ++i) {
            const std::uint32_t a = find(t[0]);
            const std::uint32_t b = find(t[i]);
            if (a == b) continue;
            label[std::max(a, b)] = std::min(a, b);
            --n;
        }
    }
    return n;
}

std::uint16_t to_channel(float sum, float n) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(sum / n, 0.0F, 65535.0F)));
}

}  // namespace

/// The live part of the collapse, renumbered.
struct LodWriter::Gathered {
    ooc::Array<CellTriple> triangles;
    std::vector<std::uint32_t> vertices;  // collapse vertex of each LOD vertex
    ooc::Array<std::uint32_t> new_index;  // LOD vertex of each collapse vertex, kNoIndex if none
    ooc::Array<std::array<float, 3>> face_normals;  // sums at LOD vertices, if normals go out
};

LodWriter::LodWriter(ooc::Context& context, const Origin& origin, const EdgeCollapse& collapse)
    : context_(context), origin_(origin), collapse_(&collapse) {}

void LodWriter::rebase(const EdgeCollapse& collapse, std::uint64_t n_clusters,
                       std::span<const std::uint32_t> cluster_of_old_vertex) {
    collapse_ = &collapse;
    origin_.n_clusters = n_clusters;
    // Any vertex of the cluster: where a cluster was cut there is no single parent any more.
    std::vector<std::uint32_t> vertex_of(n_clusters, kNoIndex);
    for (std::uint32_t v = 0; v < origin_.cluster_of_vertex.size(); ++v) {
        std::uint32_t& first = vertex_of[origin_.cluster_of_vertex[v]];
        if (first == kNoIndex) first = v;
    }
    for (std::uint32_t& v : previous_) {
        if (v == kNoIndex || cluster_of_old_vertex[v] == kNoIndex) {
            v = kNoIndex;
        } else {
            v = vertex_of[cluster_of_old_vertex[v]];
        }
    }
}

void LodWriter::write(MeshSink& sink, LodReport& report) {
    const CollapseMesh& mesh = collapse_->mesh();
    Gathered lod;
    lod.triangles = {context_.budget(), "LOD triangles", collapse_->n_triangles()};
    const std::uint64_t n_all = mesh.vertices.size();
    lod.new_index = {context_.budget(), "LOD vertices", n_all};
    const ooc::Reservation vertex_bytes =
        context_.budget().reserve("LOD vertices", kBytesPerVertex * collapse_->n_vertices());
    std::uint64_t n = 0;
    for (std::uint64_t t = 0; t < mesh.triangles.size(); ++t) {
        if (collapse_->is_live_triangle(t)) lod.triangles[n++] = mesh.triangles[t];
    }
    {
        const ooc::Reservation scratch = context_.budget().reserve(
            "vertex cache order", streaming::vertex_cache_order_bytes(n, n_all));
        streaming::order_for_vertex_cache(lod.triangles.span(), n_all, lod.new_index.span());
    }
    lod.vertices.resize(collapse_->n_vertices());
    for (std::uint32_t v = 0; v < n_all; ++v) {
        if (lod.new_index[v] != streaming::kUnusedVertex) lod.vertices[lod.new_index[v]] = v;
    }

    report.triangles = n;
    report.vertices = lod.vertices.size();
    const EdgeCounts edges = count_edges(context_, lod.triangles.span(), report.vertices);
    report.topology.border_edges = edges.border;
    report.topology.nonmanifold_edges = edges.nonmanifold;
    report.topology.components = count_components(lod.triangles.span(), report.vertices);
    report.topology.euler_characteristic = static_cast<std::int64_t>(report.vertices) -
                                           static_cast<std::int64_t>(edges.edges) +
                                           static_cast<std::int64_t>(n);
    measure_displacement(lod, report);

    Bounds bounds;
    for (const std::uint32_t v : lod.vertices) {
        bounds.extend(origin_.store.to_model(origin_.frame + mesh.vertices[v].position));
    }
    report.bounds = bounds;
    SinkHeader header;
    header.n_vertices = report.vertices;
    header.n_triangles = n;
    header.has_normals = origin_.has_normals;
    header.has_colors = origin_.has_colors;
    header.has_alpha = origin_.has_alpha;
    header.bounds = bounds;
    header.has_double_positions = origin_.has_double_positions;
    sink.begin(header);
    send_vertices(sink, lod);
    std::vector<Triangle> piece;
    for (std::uint64_t begin = 0; begin < n; begin += kPiece) {
        piece.clear();
        for (std::uint64_t t = begin; t < std::min(n, begin + kPiece); ++t) {
            const CellTriple& c = lod.triangles[t];
            piece.push_back({c[0], c[1], c[2]});
            add_to_hash(c[0] | static_cast<std::uint64_t>(c[1]) << 32);
            add_to_hash(c[2]);
        }
        sink.add_triangles(piece);
        context_.check_stop();
    }

    parents_.clear();
    parents_.reserve(previous_.size());
    for (const std::uint32_t v : previous_) {
        const std::uint32_t now = v == kNoIndex ? kNoIndex : collapse_->representative(v);
        parents_.push_back(now == kNoIndex ? std::numeric_limits<std::uint64_t>::max()
                                           : lod.new_index[now]);
    }
    previous_ = std::move(lod.vertices);
}

void LodWriter::send_vertices(MeshSink& sink, const Gathered& lod) {
    const CollapseMesh& mesh = collapse_->mesh();
    const std::uint64_t n = lod.vertices.size();
    // Stands in where a vertex has no usable normal of its own.
    std::vector<std::array<float, 3>> face_normals;
    if (origin_.has_normals) {
        face_normals.resize(n);
        for (const CellTriple& t : lod.triangles) {
            const Vec3& p = mesh.vertices[lod.vertices[t[0]]].position;
            const Vec3 normal = cross(mesh.vertices[lod.vertices[t[1]]].position - p,
                                      mesh.vertices[lod.vertices[t[2]]].position - p);
            for (const std::uint32_t v : t) {
                for (std::size_t i = 0; i < 3; ++i) {
                    face_normals[v][i] += static_cast<float>(normal[i]);
                }
            }
        }
    }
    std::vector<Vec3> positions;
    std::vector<std::array<float, 3>> normals;
    std::vector<Rgba16> colors;
    for (std::uint64_t begin = 0; begin < n; begin += kPiece) {
        positions.clear();
        normals.clear();
        colors.clear();
        for (std::uint64_t i = begin; i < std::min(n, begin + kPiece); ++i) {
            const std::uint32_t v = lod.vertices[i];
            const Vec3 p = origin_.store.to_model(origin_.frame + mesh.vertices[v].position);
            for (const double x : p) add_to_hash(std::bit_cast<std::uint64_t>(x));
            positions.push_back(p);
            if (origin_.has_normals) {
                auto normal = mesh.attributes[v].normal;
                const auto length = [&] {
                    return std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] +
                                     normal[2] * normal[2]);
                };
                if (!(length() > 1e-3F)) normal = face_normals[i];
                const float l = length();
                if (l > 0) {
                    for (float& x : normal) x /= l;
                } else {
                    normal = {0, 0, 1};
                }
                normals.push_back(normal);
            }
            if (origin_.has_colors) {
                const auto& a = mesh.attributes[v];
                const float count = std::max(a.n_colors, 1.0F);
                colors.push_back({to_channel(a.color[0], count), to_channel(a.color[1], count),
                                  to_channel(a.color[2], count), to_channel(a.color[3], count)});
            }
        }
        sink.add_vertices({positions, normals, colors});
    }
}

void LodWriter::measure_displacement(const Gathered& lod, LodReport& report) const {
    // Vertices of each cluster as linked lists.
    const CollapseMesh& mesh = collapse_->mesh();
    const std::uint64_t n_vertices = origin_.cluster_of_vertex.size();
    ooc::Array<std::uint32_t> first(context_.budget(), "vertices of clusters", origin_.n_clusters);
    ooc::Array<std::uint32_t> next(context_.budget(), "vertices of clusters", n_vertices);
    std::fill(first.begin(), first.end(), kNoIndex);
    for (std::uint32_t v = 0; v < n_vertices; ++v) {
        next[v] = std::exchange(first[origin_.cluster_of_vertex[v]], v);
    }
    std::atomic<double> farthest{0};
    std::atomic<std::uint64_t> n_lost{0};
    context_.workers().for_ranges(
        origin_.cluster_of_cell.size(), 1 << 14, [&](std::uint64_t begin, std::uint64_t end) {
            double local = 0;
            std::uint64_t lost = 0;
            for (std::uint64_t cell = begin; cell < end; ++cell) {
                const Vec3 center = origin_.store.center(cell) - origin_.frame;
                const Vec3 low = center - Vec3{0.5, 0.5, 0.5};
                const Vec3 high = center + Vec3{0.5, 0.5, 0.5};
                bool is_lost = true;
                for (std::uint32_t v = first[origin_.cluster_of_cell[cell]]; v != kNoIndex;
                     v = next[v]) {
                    const std::uint32_t now = collapse_->representative(v);
                    if (now == kNoIndex || lod.new_index[now] == streaming::kUnusedVertex) continue;
                    is_lost = false;
                    local =
                        std::max(local, farthest_corner(low, high, mesh.vertices[now].position));
                }
                if (is_lost) ++lost;
            }
            n_lost.fetch_add(lost, std::memory_order_relaxed);
            double seen = farthest.load(std::memory_order_relaxed);
            while (seen < local && !farthest.compare_exchange_weak(seen, local)) {
            }
        });
    report.error_bound = farthest * origin_.store.grid.cell_size(origin_.store.lattice);
    report.lost_cells = n_lost;
}

}  // namespace hewer::rsimp
