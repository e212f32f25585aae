// SPDX-License-Identifier: MIT
#include "rsimp/copy.h"

#include <cmath>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/parallel.h"
#include "ooc/ranked_set.h"
#include "rsimp/input_findings.h"
#include "streaming/equal_corners.h"
#include "streaming/ordered_points.h"
#include "streaming/topology_counter.h"
#include "streaming/topology_scan.h"
#include "streaming/weld.h"

namespace hewer::rsimp {

namespace {

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

class Copier {
  public:
    Copier(ooc::Context& context, MeshSource& source, MeshSink& sink,
           const SimplifyOptions& options, StageLog& stages, SimplifyReport& report, LodReport& lod)
        : context_(context),
          source_(source),
          info_(source.info()),
          sink_(sink),
          is_strict_(options.strict),
          most_resident_(options.tuning.window_vertices),
          stages_(stages),
          input_(report.input),
          lod_(lod),
          batches_(context.budget().reserve("batches of a copy",
                                            context.n_threads() * kCopyBatchBytes)) {}

    ooc::ResultHash run() {
        describe_input(info_, input_);
        if (info_.is_indexed) {
            copy_indexed();
        } else if (sink_.takes_points()) {
            copy_points();
        } else {
            copy_welded();
        }
        return hash_;
    }

  private:
    void copy_indexed() {
        ooc::RankedSet used(context_.budget(), "vertices of a copy", info_.n_vertices);
        survey(used);
        lod_.vertices = used.number();
        begin_writing();
        if (sink_.takes_points()) {
            streaming::stream_points(context_, source_, most_resident_,
                                     [&](auto triangles) { send(triangles); });
            return;
        }
        send_vertices(used);
        send_triangles(used);
    }

    /// Finds what is left out, what is used, and all counts.
    void survey(ooc::RankedSet& used) {
        ooc::RankedSet finite(context_.budget(), "finite vertices of a copy", info_.n_vertices);
        stages_.begin("vertices", info_.n_vertices, "vertices");
        std::mutex mutex;
        source_.begin_vertices();
        context_.workers().on_each([&](unsigned) {
            VertexBatch batch;
            while (source_.next_vertices(batch)) {
                const std::lock_guard lock(mutex);
                for (std::size_t i = 0; i < batch.positions.size(); ++i) {
                    if (!is_finite(batch.positions[i])) continue;
                    input_.bounds.extend(batch.positions[i]);
                    finite.insert(batch.first + i);
                }
                input_.defects.merge(batch.defects);
                context_.advance(batch.positions.size());
            }
        });
        ++input_.vertex_passes;
        stages_.begin("triangles", info_.n_faces, "faces");
        streaming::TopologyCounter topology(context_, info_.n_vertices,
                                            streaming::ample_sort_bytes(context_));
        std::vector<Triangle> kept;
        std::uint64_t n_nonfinite = 0;
        streaming::for_triangle_batches(context_, source_, [&](const TriangleBatch& batch) {
            kept.clear();
            for (const Triangle& t : batch.corners) {
                if (streaming::is_degenerate(t)) {
                    ++input_.defects.degenerate_triangles;
                } else if (finite.has(t[0]) && finite.has(t[1]) && finite.has(t[2])) {
                    kept.push_back(t);
                    for (const std::uint64_t v : t) used.insert(v);
                } else {
                    ++n_nonfinite;
                }
            }
            input_.defects.merge(batch.defects);
            input_.triangles += batch.corners.size();
            lod_.triangles += kept.size();
            topology.add(kept);
        });
        ++input_.triangle_passes;
        input_.triangles -= n_nonfinite;
        input_.defects.nonfinite_triangles += n_nonfinite;
        judge();
        lod_.topology = topology.finish();
        lod_.bounds = input_.bounds;
    }

    void send_vertices(const ooc::RankedSet& used) {
        VertexBatch batch;
        source_.begin_vertices();
        while (source_.next_vertices(batch)) {
            keep_used(used, batch);
            for (const Vec3& p : batch.positions) hash_.add(p);
            sink_.add_vertices({batch.positions, batch.normals, batch.colors});
            context_.check_stop();
        }
        ++input_.vertex_passes;
    }

    static void keep_used(const ooc::RankedSet& used, VertexBatch& batch) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
            if (!used.has(batch.first + i)) continue;
            batch.positions[n] = batch.positions[i];
            if (!batch.normals.empty()) batch.normals[n] = batch.normals[i];
            if (!batch.colors.empty()) batch.colors[n] = batch.colors[i];
            ++n;
        }
        batch.positions.resize(n);
        if (!batch.normals.empty()) batch.normals.resize(n);
        if (!batch.colors.empty()) batch.colors.resize(n);
    }

    void send_triangles(const ooc::RankedSet& used) {
        TriangleBatch batch;
        std::vector<Triangle> kept;
        source_.begin_triangles();
        while (source_.next_triangles(batch)) {
            kept.clear();
            for (const Triangle& t : batch.corners) {
                // A vertex that is not finite is not used.
                if (streaming::is_degenerate(t)) continue;
                if (!used.has(t[0]) || !used.has(t[1]) || !used.has(t[2])) continue;
                kept.push_back({used.rank(t[0]), used.rank(t[1]), used.rank(t[2])});
            }
            send(kept);
        }
        ++input_.triangle_passes;
    }

    void copy_points() {
        stages_.begin("triangles", info_.n_faces, "faces");
        lod_.topology = streaming::count_topology(context_, source_);
        for_each_piece([&](const auto& kept, const TriangleBatch& batch) {
            input_.defects.merge(batch.defects);
            input_.defects.degenerate_triangles += batch.points.size() - kept.size();
            input_.triangles += batch.points.size();
            lod_.triangles += kept.size();
            for (const auto& t : kept) {
                for (const Vec3& p : t) lod_.bounds.extend(p);
            }
        });
        input_.triangle_passes += 3;
        input_.bounds = lod_.bounds;
        judge();
        begin_writing();
        for_each_piece([&](const auto& kept, const TriangleBatch&) { send(kept); });
    }

    template <typename Take>
    void for_each_piece(const Take& take) {
        TriangleBatch batch;
        std::vector<std::array<Vec3, 3>> kept;
        source_.begin_triangles();
        while (source_.next_triangles(batch)) {
            kept.clear();
            for (const auto& t : batch.points) {
                if (!streaming::is_degenerate(t)) kept.push_back(t);
            }
            take(std::as_const(kept), std::as_const(batch));
            context_.check_stop();
        }
    }

    void copy_welded() {
        stages_.begin("triangles", info_.n_faces, "faces");
        streaming::Weld mesh(context_, source_);
        input_.triangle_passes += 2;
        input_.defects.merge(mesh.defects());
        lod_.triangles = mesh.n_triangles();
        lod_.vertices = mesh.n_vertices();
        input_.triangles = lod_.triangles + input_.defects.degenerate_triangles;
        judge();
        input_.bounds = lod_.bounds = mesh.bounds();
        begin_writing();
        mesh.for_vertices([&](std::span<const Vec3> piece) {
            for (const Vec3& p : piece) hash_.add(p);
            sink_.add_vertices({piece, {}, {}});
        });
        streaming::TopologyCounter topology(context_, lod_.vertices,
                                            streaming::ample_sort_bytes(context_));
        mesh.for_triangles([&](std::span<const Triangle> piece) {
            topology.add(piece);
            send(piece);
        });
        lod_.topology = topology.finish();
    }

    void judge() {
        judge_findings(context_, source_, is_strict_, input_);
        if (lod_.triangles > 0) return;
        throw FormatError(info_.name + ": has " + std::to_string(info_.n_faces) +
                          " faces, but not one triangle with three corners");
    }

    void begin_writing() {
        stages_.begin("write", 0, "bytes");
        SinkHeader header;
        header.n_vertices = lod_.vertices;
        header.n_triangles = lod_.triangles;
        header.has_normals = info_.has_normals;
        header.has_colors = info_.has_colors;
        header.has_alpha = info_.has_alpha;
        header.bounds = lod_.bounds;
        header.has_double_positions = info_.has_double_positions;
        held_ = context_.budget().reserve("compressed output", sink_.held_bytes(header));
        sink_.begin(header);
    }

    void send(std::span<const Triangle> triangles) {
        for (const Triangle& t : triangles) hash_.add(t);
        sink_.add_triangles(triangles);
        context_.check_stop();
    }
    void send(std::span<const std::array<Vec3, 3>> triangles) {
        for (const auto& t : triangles) {
            for (const Vec3& p : t) hash_.add(p);
        }
        sink_.add_points(triangles);
        context_.check_stop();
    }

    ooc::Context& context_;
    MeshSource& source_;
    const SourceInfo& info_;
    MeshSink& sink_;
    bool is_strict_;
    std::uint64_t most_resident_;
    StageLog& stages_;
    InputReport& input_;
    LodReport& lod_;
    ooc::Reservation batches_;
    ooc::Reservation held_;
    ooc::ResultHash hash_;
};

}  // namespace

ooc::ResultHash copy_mesh(ooc::Context& context, MeshSource& source, MeshSink& sink,
                          const SimplifyOptions& options, StageLog& stages, SimplifyReport& report,
                          LodReport& lod) {
    return Copier(context, source, sink, options, stages, report, lod).run();
}

}  // namespace hewer::rsimp
