// SPDX-License-Identifier: MIT
#include "hewer/info.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/array.h"
#include "ooc/context.h"
#include "ooc/parallel.h"
#include "ooc/progress_part.h"
#include "ooc/units.h"
#include "streaming/glance.h"
#include "streaming/topology_scan.h"

namespace hewer {

namespace {

// Sums of doubles that do not depend on the order of the batches: each batch adds up by itself, the
// batches by their place in the file. 16 bytes for a batch of thousands of triangles.
class OrderedSum {
  public:
    void add(std::uint64_t first, double value) { parts_.emplace_back(first, value); }
    [[nodiscard]] double total() {
        std::sort(parts_.begin(), parts_.end());
        double sum = 0;
        for (const auto& [first, value] : parts_) sum += value;
        return sum;
    }

  private:
    std::vector<std::pair<std::uint64_t, double>> parts_;
};

// Vertex positions as precise as the file has them; absent when they do not fit.
using Positions = std::variant<std::monostate, ooc::Array<std::array<float, 3>>, ooc::Array<Vec3>>;

// Batches and file blocks that a thread has in flight, rounded up.
constexpr std::uint64_t kBatchBytes = 4ULL << 20;
// Share of the time for an input that is imported, for progress.
constexpr double kImported = 0.7;

Positions make_positions(const SourceInfo& source, ooc::Context& context) {
    const std::uint64_t vertex_bytes = source.has_double_positions ? 24 : 12;
    const std::uint64_t available =
        context.budget().available() -
        std::min(context.budget().available(), context.n_threads() * kBatchBytes);
    if (source.n_vertices == 0) return {};
    if (source.n_vertices > available / vertex_bytes) {
        context.warn(source.name +
                     ": the vertices do not fit the memory limit, so area and "
                     "degenerate triangles were left out; --memory " +
                     ooc::format_bytes(context.budget().used() + context.n_threads() * kBatchBytes +
                                       source.n_vertices * vertex_bytes) +
                     " would do");
        return {};
    }
    if (source.has_double_positions) {
        return ooc::Array<Vec3>(context.budget(), "vertex positions", source.n_vertices);
    }
    return ooc::Array<std::array<float, 3>>(context.budget(), "vertex positions",
                                            source.n_vertices);
}

void store(Positions& positions, std::uint64_t id, const Vec3& p) {
    if (auto* doubles = std::get_if<ooc::Array<Vec3>>(&positions)) {
        (*doubles)[id] = p;
    } else if (auto* floats = std::get_if<ooc::Array<std::array<float, 3>>>(&positions)) {
        (*floats)[id] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                         static_cast<float>(p[2])};
    }
}

Vec3 load(const Positions& positions, std::uint64_t id) {
    if (const auto* doubles = std::get_if<ooc::Array<Vec3>>(&positions)) return (*doubles)[id];
    const auto& p = std::get<ooc::Array<std::array<float, 3>>>(positions)[id];
    return {p[0], p[1], p[2]};
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

double area_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const Vec3 v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const Vec3 n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return 0.5 * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

class Inspector {
  public:
    Inspector(MeshSource& source, ooc::Context& context)
        : source_(source), context_(context), positions_(make_positions(source.info(), context)) {}

    void read_vertices() {
        context_.begin_stage("vertices", source_.info().n_vertices, "vertices");
        source_.begin_vertices();
        context_.workers().on_each([&](unsigned) {
            VertexBatch batch;
            while (source_.next_vertices(batch)) {
                Bounds bounds;
                for (std::size_t i = 0; i < batch.positions.size(); ++i) {
                    const Vec3& p = batch.positions[i];
                    if (is_finite(p)) bounds.extend(p);
                    store(positions_, batch.first + i, p);
                }
                {
                    const std::lock_guard lock(mutex_);
                    bounds_.extend(bounds);
                    defects_.merge(batch.defects);
                }
                context_.advance(batch.positions.size());
            }
        });
        context_.end_stage();
    }

    void read_triangles() {
        context_.begin_stage("triangles", source_.info().n_faces, "faces");
        source_.begin_triangles();
        context_.workers().on_each([&](unsigned) {
            TriangleBatch batch;
            while (source_.next_triangles(batch)) {
                inspect(batch);
                context_.advance(batch.n_faces);
            }
        });
        context_.end_stage();
    }

    void fill(InputReport& report) {
        report.bounds = bounds_;
        report.triangles = n_triangles_;
        report.defects = defects_;
        report.defects.nonfinite_triangles += n_nonfinite_;
        report.defects.degenerate_triangles += n_degenerate_;
        report.area = area_.total();
    }

  private:
    void inspect(const TriangleBatch& batch) {
        Bounds bounds;
        double area = 0;
        std::uint64_t n_degenerate = 0;
        const auto add = [&](double triangle_area) {
            area += triangle_area;
            if (triangle_area == 0) ++n_degenerate;
        };
        // A repeated corner has no area either, and is counted with it. A source cannot know that
        // an indexed triangle has a corner that is not finite; here it shows.
        std::uint64_t n_nonfinite = 0;
        if (!std::holds_alternative<std::monostate>(positions_)) {
            for (const Triangle& t : batch.corners) {
                const Vec3 a = load(positions_, t[0]);
                const Vec3 b = load(positions_, t[1]);
                const Vec3 c = load(positions_, t[2]);
                if (is_finite(a) && is_finite(b) && is_finite(c)) {
                    add(area_of(a, b, c));
                } else {
                    ++n_nonfinite;
                }
            }
        }
        for (const auto& corners : batch.points) {
            for (const Vec3& p : corners) bounds.extend(p);
            add(area_of(corners[0], corners[1], corners[2]));
        }
        const std::lock_guard lock(mutex_);
        bounds_.extend(bounds);
        defects_.merge(batch.defects);
        n_triangles_ += batch.corners.size() + batch.points.size() - n_nonfinite;
        n_nonfinite_ += n_nonfinite;
        n_degenerate_ += n_degenerate;
        area_.add(batch.first_face, area);
    }

    MeshSource& source_;
    ooc::Context& context_;
    Positions positions_;
    std::mutex mutex_;
    InputDefects defects_;
    Bounds bounds_;
    std::uint64_t n_triangles_ = 0;
    std::uint64_t n_nonfinite_ = 0;
    std::uint64_t n_degenerate_ = 0;
    OrderedSum area_;
};

}  // namespace

InputReport info(const InputPaths& input, const InfoOptions& options, const Hooks& hooks) {
    if (!options.with_topology) {
        const auto glanced =
            streaming::glance(list_files(input), options.whole_below, opening(options), hooks);
        if (glanced) return *glanced;
    }
    const std::unique_ptr<MeshSource> source =
        open_mesh(input, opening(options), ooc::part_of(hooks, 0, kImported));
    const double from = source->held_temp_bytes() > 0 ? kImported : 0;
    // A face costs about as much to read as two vertices, and there are twice as many.
    std::vector<ooc::StageWeight> stages{{"vertices", 1}, {"triangles", 4}};
    if (options.with_topology) stages.push_back({"topology", 20});
    ooc::Context context({.memory_bytes = options.memory_bytes,
                          .n_threads = options.n_threads,
                          .temp_dir = options.temp_dir,
                          .max_temp_bytes = options.max_temp_bytes},
                         ooc::part_of(hooks, from, 1), std::move(stages));
    const ooc::HeldInput held = context.hold(*source);
    const SourceInfo& about = source->info();

    InputReport report;
    report.path = about.name;
    report.format = about.format;
    report.bytes = about.n_bytes;
    report.vertices = about.n_vertices;
    report.faces = about.n_faces;
    report.has_normals = about.has_normals;
    report.has_colors = about.has_colors;
    report.textures = about.textures;
    report.ignored = about.ignored;

    {
        Inspector inspector(*source, context);
        if (about.is_indexed) {
            inspector.read_vertices();
            report.vertex_passes = 1;
        }
        inspector.read_triangles();
        report.triangle_passes = 1;
        inspector.fill(report);
    }
    if (options.with_topology) {
        context.begin_stage("topology", about.n_faces, "faces");
        report.topology = streaming::count_topology(context, *source);
        context.end_stage();
        ++report.triangle_passes;
    }
    return report;
}

}  // namespace hewer
