// SPDX-License-Identifier: MIT
#include "measure/resident_surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <mutex>
#include <span>
#include <utility>

#include "hewer/error.h"
#include "ooc/parallel.h"

namespace hewer::measuring {

namespace {

// No point of a lattice: stands for a vertex that is not finite or not used.
constexpr std::int32_t kAbsent = std::numeric_limits<std::int32_t>::min();

void mark(ooc::Array<std::uint64_t>& bits, std::uint64_t i) {
    const std::atomic_ref word(bits[i / 64]);
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    // Most vertices are marked already when they are met: a look is cheaper than a locked write.
    if ((word.load(std::memory_order_relaxed) & bit) == 0) {
        word.fetch_or(bit, std::memory_order_relaxed);
    }
}

bool is_marked(const ooc::Array<std::uint64_t>& bits, std::uint64_t i) {
    return (bits[i / 64] >> (i % 64) & 1) != 0;
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

[[noreturn]] void throw_changed(const MeshSource& source) {
    throw FormatError(source.info().name + ": changed while it was being read");
}

/// body(batch) for every batch of triangles, on all threads.
template <typename Body>
void for_triangle_batches(ooc::Context& context, MeshSource& source, const Body& body) {
    source.begin_triangles();
    context.workers().on_each([&](unsigned) {
        TriangleBatch batch;
        while (source.next_triangles(batch)) {
            body(batch);
            context.advance(batch.n_faces);
        }
    });
}

template <typename Body>
void for_vertex_batches(ooc::Context& context, MeshSource& source, const Body& body) {
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        VertexBatch batch;
        while (source.next_vertices(batch)) {
            if (batch.first + batch.positions.size() > source.info().n_vertices) {
                throw_changed(source);
            }
            body(batch);
            context.advance(batch.positions.size());
        }
    });
}

/// Morton order without keys: the axis whose coordinates differ in the highest bit decides (Chan
/// 2002). A total order; equal points become neighbours.
bool morton_less(const LatticePoint& p, const LatticePoint& q) {
    std::size_t axis = 0;
    std::uint32_t most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto x = static_cast<std::uint32_t>(p[i]) ^ static_cast<std::uint32_t>(q[i]);
        if (most < x && most < (most ^ x)) {
            axis = i;
            most = x;
        }
    }
    return p[axis] < q[axis];
}

void sort_points(ooc::Context& context, std::span<LatticePoint> points) {
    context.workers().execute(
        [&] { tbb::parallel_sort(points.begin(), points.end(), morton_less); });
}

void load_vertices(ooc::Context& context, MeshSource& source, const Census& census,
                   const Lattice& lattice, ooc::Array<LatticePoint>& points) {
    for_vertex_batches(context, source, [&](const VertexBatch& batch) {
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
            const std::uint64_t id = batch.first + i;
            const Vec3& p = batch.positions[i];
            points[id] = is_marked(census.used, id) && is_finite(p)
                             ? lattice.from_model(p)
                             : LatticePoint{kAbsent, kAbsent, kAbsent};
        }
    });
}

/// Triangles whose corners are all there; marks the vertices they use.
void load_indexed_triangles(ooc::Context& context, MeshSource& source, ResidentSurface& surface,
                            ooc::Array<std::uint64_t>& used) {
    std::atomic<std::uint64_t> n{0};
    const auto is_kept = [&](const Triangle& t) {
        return std::all_of(t.begin(), t.end(),
                           [&](std::uint64_t v) { return surface.points[v][0] != kAbsent; });
    };
    for_triangle_batches(context, source, [&](const TriangleBatch& batch) {
        const auto count = static_cast<std::uint64_t>(
            std::count_if(batch.corners.begin(), batch.corners.end(), is_kept));
        std::uint64_t at = n.fetch_add(count);
        if (at + count > surface.triangles.size()) throw_changed(source);
        for (const Triangle& t : batch.corners) {
            if (!is_kept(t)) continue;
            surface.triangles[at++] = {surface.points[t[0]], surface.points[t[1]],
                                       surface.points[t[2]]};
            for (const std::uint64_t v : t) mark(used, v);
        }
    });
    surface.n_triangles = n;
}

void load_soup(ooc::Context& context, MeshSource& source, const Lattice& lattice,
               ResidentSurface& surface) {
    std::atomic<std::uint64_t> n{0};
    for_triangle_batches(context, source, [&](const TriangleBatch& batch) {
        std::uint64_t at = n.fetch_add(batch.points.size());
        if (at + batch.points.size() > surface.triangles.size()) throw_changed(source);
        for (const std::array<Vec3, 3>& t : batch.points) {
            for (std::size_t k = 0; k < 3; ++k) {
                surface.triangles[at][k] = lattice.from_model(t[k]);
                surface.points[3 * at + k] = surface.triangles[at][k];
            }
            ++at;
        }
    });
    surface.n_triangles = n;
}

}  // namespace

Census take_census(ooc::Context& context, MeshSource& source) {
    Census census;
    census.used = ooc::Array<std::uint64_t>(context.budget(),
                                            "marks of used vertices of " + source.info().name,
                                            source.info().n_vertices / 64 + 1);
    std::atomic<std::uint64_t> n{0};
    std::mutex mutex;
    const auto merge = [&](const Bounds& bounds) {
        const std::lock_guard lock(mutex);
        census.bounds.extend(bounds);
    };
    for_triangle_batches(context, source, [&](const TriangleBatch& batch) {
        n += batch.corners.size() + batch.points.size();
        for (const Triangle& t : batch.corners) {
            for (const std::uint64_t v : t) mark(census.used, v);
        }
        Bounds bounds;
        for (const auto& t : batch.points) {
            for (const Vec3& p : t) bounds.extend(p);
        }
        merge(bounds);
    });
    census.n_triangles = n;
    if (source.info().is_indexed) {
        for_vertex_batches(context, source, [&](const VertexBatch& batch) {
            Bounds bounds;
            for (std::size_t i = 0; i < batch.positions.size(); ++i) {
                const Vec3& p = batch.positions[i];
                if (is_marked(census.used, batch.first + i) && is_finite(p)) bounds.extend(p);
            }
            merge(bounds);
        });
    }
    return census;
}

std::uint64_t ResidentSurface::bytes(const MeshSource& source, const Census& census) {
    const std::uint64_t n_points =
        source.info().is_indexed ? source.info().n_vertices : 3 * census.n_triangles;
    return census.n_triangles * sizeof(LatticeTriangle) + n_points * sizeof(LatticePoint);
}

ResidentSurface load_surface(ooc::Context& context, MeshSource& source, Census census,
                             const Lattice& lattice) {
    ResidentSurface surface;
    const std::string& name = source.info().name;
    surface.triangles =
        ooc::Array<LatticeTriangle>(context.budget(), "triangles of " + name, census.n_triangles);
    if (source.info().is_indexed) {
        surface.points = ooc::Array<LatticePoint>(context.budget(), "vertices of " + name,
                                                  source.info().n_vertices);
        load_vertices(context, source, census, lattice, surface.points);
        // From here on the marks are of those that a triangle without a non-finite corner uses.
        std::fill(census.used.begin(), census.used.end(), 0);
        load_indexed_triangles(context, source, surface, census.used);
        for (std::uint64_t i = 0; i < surface.points.size(); ++i) {
            if (is_marked(census.used, i)) surface.points[surface.n_points++] = surface.points[i];
        }
        sort_points(context, surface.points.span().first(surface.n_points));
    } else {
        surface.points = ooc::Array<LatticePoint>(context.budget(), "corners of " + name,
                                                  3 * census.n_triangles);
        load_soup(context, source, lattice, surface);
        const auto corners = surface.points.span().first(3 * surface.n_triangles);
        sort_points(context, corners);
        surface.n_points = static_cast<std::uint64_t>(std::unique(corners.begin(), corners.end()) -
                                                      corners.begin());
    }
    return surface;
}

}  // namespace hewer::measuring
