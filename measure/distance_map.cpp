// SPDX-License-Identifier: MIT
#include "measure/distance_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "measure/points.h"
#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {

constexpr std::uint64_t kPerTask = 1024;  // vertices
constexpr Rgba16 kGrey{0x8080, 0x8080, 0x8080, 0xffff};

class MapWriter {
  public:
    MapWriter(ooc::Context& context, MeshSource& source, const Census& census,
              const Lattice& lattice, const FindDistances& distances, double range, MeshSink& sink)
        : context_(context),
          source_(source),
          census_(census),
          lattice_(lattice),
          distances_(distances),
          range_(range),
          sink_(sink) {}

    void write() {
        const SourceInfo& info = source_.info();
        SinkHeader header;
        header.n_vertices = info.is_indexed ? info.n_vertices : 3 * census_.n_triangles;
        header.n_triangles = census_.n_triangles;
        header.has_colors = true;
        header.bounds = census_.bounds;
        header.has_double_positions = info.has_double_positions;
        sink_.begin(header);
        if (info.is_indexed) {
            write_vertices();
        } else {
            write_corners();
        }
        write_triangles();
        sink_.finish();
    }

  private:
    template <typename Counts>
    void color_and_add(const Counts& counts) {
        colors_.resize(positions_.size());
        context_.workers().for_ranges(
            positions_.size(), kPerTask, [&](std::uint64_t begin, std::uint64_t end) {
                std::vector<LatticePoint> points;
                for (std::uint64_t i = begin; i < end; ++i) {
                    if (counts(i)) points.push_back(lattice_.from_model(positions_[i]));
                }
                std::vector<double> found(points.size());
                distances_(points, found);
                std::size_t next = 0;
                for (std::uint64_t i = begin; i < end; ++i) {
                    colors_[i] = counts(i) ? ramp_color(found[next++] / range_) : kGrey;
                }
            });
        for (Vec3& p : positions_) {
            if (!is_finite(p)) p = census_.bounds.min;
        }
        sink_.add_vertices({positions_, {}, colors_});
    }
    void write_vertices() {
        source_.begin_vertices();
        VertexBatch batch;
        while (source_.next_vertices(batch)) {
            positions_ = batch.positions;
            color_and_add([&](std::uint64_t i) { return census_.used.get(batch.first + i); });
            context_.advance(batch.positions.size());
        }
    }
    void write_corners() {
        source_.begin_triangles();
        TriangleBatch batch;
        while (source_.next_triangles(batch)) {
            positions_.clear();
            for (const auto& t : batch.points) {
                positions_.insert(positions_.end(), t.begin(), t.end());
            }
            color_and_add([](std::uint64_t) { return true; });
            context_.advance(batch.n_faces);
        }
    }
    void write_triangles() {
        if (!source_.info().is_indexed) {
            for (std::uint64_t t = 0; t < census_.n_triangles; ++t) {
                const Triangle triangle{3 * t, 3 * t + 1, 3 * t + 2};
                sink_.add_triangles({&triangle, 1});
            }
            return;
        }
        source_.begin_triangles();
        TriangleBatch batch;
        while (source_.next_triangles(batch)) {
            // A triangle counts if its corners are finite, and then they are marked.
            std::erase_if(batch.corners, [&](const Triangle& t) {
                return !std::all_of(t.begin(), t.end(),
                                    [&](std::uint64_t v) { return census_.used.get(v); });
            });
            sink_.add_triangles(batch.corners);
            context_.advance(batch.n_faces);
        }
    }

    ooc::Context& context_;
    MeshSource& source_;
    const Census& census_;
    const Lattice& lattice_;
    const FindDistances& distances_;
    double range_;
    MeshSink& sink_;
    std::vector<Vec3> positions_;
    std::vector<Rgba16> colors_;
};

}  // namespace

Rgba16 ramp_color(double share) {
    // Every eighth of the ramp, in bytes.
    constexpr std::array<std::array<double, 3>, 9> kAnchors{{{68, 1, 84},
                                                             {71, 45, 123},
                                                             {59, 82, 139},
                                                             {44, 114, 142},
                                                             {33, 145, 140},
                                                             {40, 174, 128},
                                                             {94, 201, 98},
                                                             {173, 220, 48},
                                                             {253, 231, 37}}};
    constexpr double kSteps = kAnchors.size() - 1;
    const double at = std::clamp(std::isnan(share) ? 0.0 : share, 0.0, 1.0) * kSteps;
    const auto i = std::min(static_cast<std::size_t>(at), kAnchors.size() - 2);
    const double f = at - static_cast<double>(i);
    Rgba16 color{0, 0, 0, 0xffff};
    for (std::size_t k = 0; k < 3; ++k) {
        const double byte = kAnchors[i][k] + f * (kAnchors[i + 1][k] - kAnchors[i][k]);
        color[k] = static_cast<std::uint16_t>(std::lround(byte) * 257);
    }
    return color;
}

void write_distance_map(ooc::Context& context, MeshSource& source, const Census& census,
                        const Lattice& lattice, const FindDistances& distances, double range,
                        MeshSink& sink) {
    MapWriter(context, source, census, lattice, distances, range, sink).write();
}

}  // namespace hewer::measuring
