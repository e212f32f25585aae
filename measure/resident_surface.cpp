// SPDX-License-Identifier: MIT
#include "measure/resident_surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "measure/points.h"

namespace hewer::measuring {

namespace {

void sort_points(ooc::Context& context, std::span<LatticePoint> points) {
    context.workers().execute(
        [&] { tbb::parallel_sort(points.begin(), points.end(), MortonLess()); });
}

/// Takes batches of triangles from any thread.
class TriangleStore {
  public:
    TriangleStore(const MeshSource& source, ooc::Array<LatticeTriangle>& triangles)
        : source_(source), triangles_(triangles) {}

    void add(std::span<const LatticeTriangle> batch) {
        const std::uint64_t at = n_.fetch_add(batch.size());
        if (at + batch.size() > triangles_.size()) throw_changed(source_);
        std::copy(batch.begin(), batch.end(), triangles_.begin() + at);
    }
    void check_complete() const {
        if (n_ != triangles_.size()) throw_changed(source_);
    }

  private:
    const MeshSource& source_;
    ooc::Array<LatticeTriangle>& triangles_;
    std::atomic<std::uint64_t> n_{0};
};

}  // namespace

void throw_changed(const MeshSource& source) {
    throw FormatError(source.info().name + ": changed while it was being read");
}

std::uint64_t ResidentSurface::max_points(const MeshSource& source, const Census& census) {
    return source.info().is_indexed ? source.info().n_vertices : 3 * census.n_triangles;
}

std::uint64_t ResidentSurface::bytes(const MeshSource& source, const Census& census) {
    return census.n_triangles * sizeof(LatticeTriangle) +
           max_points(source, census) * sizeof(LatticePoint);
}

ResidentSurface load_surface(ooc::Context& context, MeshSource& source, const Census& census,
                             const Lattice& lattice) {
    ResidentSurface surface;
    const std::string& name = source.info().name;
    const LatticeEncoder encoder{lattice};
    surface.triangles =
        ooc::Array<LatticeTriangle>(context.budget(), "triangles of " + name, census.n_triangles);
    TriangleStore store(source, surface.triangles);
    if (source.info().is_indexed) {
        ooc::Array<LatticePoint>& points = surface.points;
        points = {context.budget(), "vertices of " + name, source.info().n_vertices};
        for_vertex_batches(context, source, [&](unsigned, const VertexBatch& batch) {
            for (std::size_t i = 0; i < batch.positions.size(); ++i) {
                points[batch.first + i] = encoder.encode(batch.positions[i]);
            }
        });
        source.begin_triangles();
        context.workers().on_each([&](unsigned) {
            TriangleBatch batch;
            std::vector<LatticeTriangle> kept;
            while (source.next_triangles(batch)) {
                kept.clear();
                for (const Triangle& t : batch.corners) {
                    const LatticeTriangle corners{points[t[0]], points[t[1]], points[t[2]]};
                    if (std::none_of(corners.begin(), corners.end(), LatticeEncoder::is_absent)) {
                        kept.push_back(corners);
                    }
                }
                store.add(kept);
                context.advance(batch.n_faces);
            }
        });
        store.check_complete();
        for (std::uint64_t i = 0; i < points.size(); ++i) {
            if (census.used.get(i)) points[surface.n_points++] = points[i];
        }
        sort_points(context, points.span().first(surface.n_points));
    } else {
        surface.points = {context.budget(), "corners of " + name, 3 * census.n_triangles};
        source.begin_triangles();
        context.workers().on_each([&](unsigned) {
            TriangleBatch batch;
            std::vector<LatticeTriangle> kept;
            while (source.next_triangles(batch)) {
                kept.clear();
                for (const auto& t : batch.points) {
                    kept.push_back(
                        {encoder.encode(t[0]), encoder.encode(t[1]), encoder.encode(t[2])});
                }
                store.add(kept);
                context.advance(batch.n_faces);
            }
        });
        store.check_complete();
        LatticePoint* out = surface.points.begin();
        for (const LatticeTriangle& t : surface.triangles) out = std::copy(t.begin(), t.end(), out);
        sort_points(context, surface.points.span());
        surface.n_points = static_cast<std::uint64_t>(
            std::unique(surface.points.begin(), surface.points.end()) - surface.points.begin());
    }
    return surface;
}

}  // namespace hewer::measuring
