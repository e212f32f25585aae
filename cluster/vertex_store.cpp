// SPDX-License-Identifier: MIT
#include "cluster/vertex_store.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>
#include <vector>

#include "cluster/vertex_pages.h"
#include "hewer/error.h"
#include "hewer/options.h"
#include "ooc/parallel.h"
#include "ooc/vec3.h"

namespace hewer::cluster {

namespace {

bool is_finite(const Vec3& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

// Scale of the vertex normal sums: 2^-20, so that 2^43 unit normals fit.
constexpr double kNormalScale = 1 << 20;

void add_vertex(const VertexBatch& batch, std::uint64_t i, AttributeSums& sums) {
    if (!batch.colors.empty()) {
        for (std::size_t k = 0; k < 4; ++k) sums.color[k] += batch.colors[i][k];
        ++sums.n_colors;
    }
    if (!batch.normals.empty()) {
        const auto& n = batch.normals[i];
        const double length =
            std::sqrt(static_cast<double>(n[0]) * n[0] + static_cast<double>(n[1]) * n[1] +
                      static_cast<double>(n[2]) * n[2]);
        if (!(length > 0) || !std::isfinite(length)) return;
        for (std::size_t k = 0; k < 3; ++k) {
            sums.normal[k] += round_to_int(n[k] / length * kNormalScale);
        }
    }
}

/// What a weight counts as. Returns whether it is a good one.
bool add_weight(float weight, WeightSums& sums) {
    const auto w = static_cast<double>(weight);
    const bool is_number = w >= 0;
    sums.sum += static_cast<std::uint64_t>(
        round_to_int(kWeightScale * (is_number ? std::min(w, kMostWeight) : 1)));
    ++sums.n_vertices;
    return is_number && w <= kMostWeight;
}

/// One worker's view of the pass over the attributes. Vertices near each other in the file are so
/// in space: what goes to one cell is added up first, since another worker may be at the cells
/// beside it, in the same cache lines.
class AttributeAccumulator {
  public:
    AttributeAccumulator(CellTable& table, bool is_shared) : table_(table), is_shared_(is_shared) {}

    void add(std::uint32_t slot, const VertexBatch& batch, std::uint64_t i) {
        Pending& pending = pending_[slot % kPending];
        if (pending.slot != slot) {
            empty(pending);
            pending.slot = slot;
        }
        if (table_.extras().attributes) add_vertex(batch, i, pending.sums);
        if (table_.extras().weights && !add_weight(batch.weights[i], pending.weights)) {
            ++n_bad_weights_;
        }
    }
    /// Before an Admission ends.
    void flush() {
        for (Pending& pending : pending_) empty(pending);
    }
    [[nodiscard]] std::uint64_t n_bad_weights() const { return n_bad_weights_; }

  private:
    struct Pending {
        std::uint32_t slot = CellTable::kNone;
        AttributeSums sums{};
        WeightSums weights{};
    };
    void empty(Pending& pending) {
        if (pending.slot == CellTable::kNone) return;
        {
            std::uint32_t unshared = 0;
            const FieldLock lock(is_shared_ ? table_.sums(pending.slot).lock : unshared);
            if (table_.extras().attributes) table_.attributes(pending.slot) += pending.sums;
            if (table_.extras().weights) table_.weights(pending.slot) += pending.weights;
        }
        pending = {};
    }

    CellTable& table_;
    bool is_shared_;
    std::uint64_t n_bad_weights_ = 0;
    static constexpr std::uint32_t kPending = 64;
    std::array<Pending, kPending> pending_;
};

}  // namespace

void throw_outside_bounds(const MeshSource& source, const std::string& what) {
    throw FormatError(
        source.info().name + ": " + what +
        " lies outside of the given --bounds; leave the option out to have the box found");
}

Bounds scan_bounds(ooc::Context& context, MeshSource& source, InputDefects& defects) {
    Bounds bounds;
    std::mutex mutex;
    // Defects of the batches by their place, so that "first" is the file's first.
    std::map<std::uint64_t, InputDefects> by_place;
    const auto merge = [&](const Bounds& local, std::uint64_t first, const InputDefects& found) {
        const std::lock_guard lock(mutex);
        bounds.extend(local);
        if (found.nonfinite_vertices + found.nonfinite_triangles > 0) by_place[first] = found;
    };
    if (source.info().is_indexed) {
        source.begin_vertices();
        context.workers().on_each([&](unsigned) {
            VertexBatch batch;
            while (source.next_vertices(batch)) {
                Bounds local;
                for (const Vec3& p : batch.positions) {
                    if (is_finite(p)) local.extend(p);
                }
                merge(local, batch.first, batch.defects);
                context.advance(batch.positions.size());
            }
        });
    } else {
        source.begin_triangles();
        context.workers().on_each([&](unsigned) {
            TriangleBatch batch;
            while (source.next_triangles(batch)) {
                Bounds local;
                for (const auto& triangle : batch.points) {
                    for (const Vec3& p : triangle) local.extend(p);
                }
                merge(local, batch.first_face, batch.defects);
                context.advance(batch.n_faces);
            }
        });
    }
    for (const auto& [first, found] : by_place) defects.merge(found);
    if (bounds.is_empty()) {
        throw FormatError(source.info().name + ": no vertex has finite coordinates");
    }
    return bounds;
}

VertexStore load_float_vertices(ooc::Context& context, MeshSource& source, InputDefects& defects,
                                Bounds& bounds) {
    const std::uint64_t n = source.info().n_vertices;
    VertexStore store;
    store.vertices = {context.budget(), "vertices", n};
    std::mutex mutex;
    std::map<std::uint64_t, InputDefects> by_place;
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        VertexBatch batch;
        while (source.next_vertices(batch)) {
            Bounds local;
            for (std::uint64_t i = 0; i < batch.positions.size(); ++i) {
                const Vec3& p = batch.positions[i];
                const std::uint64_t v = batch.first + i;
                if (!is_finite(p)) {
                    store.vertices[v].cell = CellTable::kNone;
                    continue;
                }
                local.extend(p);
                store.vertices[v].cell = VertexPages::kUnknown;
                for (std::size_t k = 0; k < 3; ++k) {
                    store.vertices[v].point[k] =
                        std::bit_cast<std::uint32_t>(static_cast<float>(p[k]));
                }
            }
            {
                const std::lock_guard lock(mutex);
                bounds.extend(local);
                if (batch.defects.nonfinite_vertices > 0) by_place[batch.first] = batch.defects;
            }
            context.advance(batch.positions.size());
        }
    });
    for (const auto& [first, found] : by_place) defects.merge(found);
    if (bounds.is_empty()) {
        throw FormatError(source.info().name + ": no vertex has finite coordinates");
    }
    const Lattice lattice(bounds);
    context.workers().for_ranges(n, 1 << 15, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t v = begin; v < end; ++v) {
            if (!store.is_finite(v)) continue;
            Vec3 p;
            for (std::size_t k = 0; k < 3; ++k) {
                p[k] = static_cast<double>(std::bit_cast<float>(store.vertices[v].point[k]));
            }
            store.vertices[v].point = lattice.encode(p);
        }
    });
    return store;
}

VertexStore load_vertices(ooc::Context& context, MeshSource& source, const Bounds& bounds,
                          const Lattice& lattice) {
    const std::uint64_t n = source.info().n_vertices;
    VertexStore store;
    store.vertices = {context.budget(), "vertices", n};
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        VertexBatch batch;
        while (source.next_vertices(batch)) {
            for (std::uint64_t i = 0; i < batch.positions.size(); ++i) {
                const Vec3& p = batch.positions[i];
                const std::uint64_t v = batch.first + i;
                if (is_inside(bounds, p)) {
                    store.vertices[v].point = lattice.encode(p);
                    store.vertices[v].cell = VertexPages::kUnknown;
                } else if (is_finite(p)) {
                    throw_outside_bounds(source, "vertex " + std::to_string(v));
                } else {
                    store.vertices[v].cell = CellTable::kNone;
                }
            }
            context.advance(batch.positions.size());
        }
    });
    return store;
}

ooc::Spool<LatticePoint> spool_vertices(ooc::Context& context, MeshSource& source,
                                        const Bounds& bounds, const Lattice& lattice) {
    ooc::Spool<LatticePoint> spool(context, "vertices");
    source.begin_vertices();
    VertexBatch batch;
    std::vector<LatticePoint> points;
    // One thread: batches have to come in order. Sources that cannot seek are slow to parse anyway.
    while (source.next_vertices(batch)) {
        points.clear();
        for (std::uint64_t i = 0; i < batch.positions.size(); ++i) {
            const Vec3& p = batch.positions[i];
            if (is_inside(bounds, p)) {
                points.push_back(lattice.encode(p));
            } else if (is_finite(p)) {
                throw_outside_bounds(source, "vertex " + std::to_string(batch.first + i));
            } else {
                points.push_back(VertexPages::kNotFinite);
            }
        }
        spool.append(points);
        context.advance(batch.positions.size());
    }
    return spool;
}

std::uint64_t add_vertex_attributes(ooc::Context& context, MeshSource& source,
                                    const Lattice& lattice, const UniformGrid& grid,
                                    CellTable& table, const VertexPages* pages) {
    std::atomic<std::uint64_t> n_bad_weights{0};
    const std::uint64_t n_admitted = table.share();
    source.begin_vertices();
    context.workers().on_each([&](unsigned) {
        AttributeAccumulator accumulator(table, context.n_threads() > 1);
        VertexBatch batch;
        std::vector<std::uint64_t> unknown;
        const auto add_known = [&](std::uint64_t begin, std::uint64_t end) {
            const CellTable::Admission admission(table, 0);
            for (std::uint64_t i = begin; i < end; ++i) {
                const std::uint32_t slot =
                    pages != nullptr ? pages->slot_of(batch.first + i) : VertexPages::kUnknown;
                if (slot == VertexPages::kUnknown) {
                    if (is_finite(batch.positions[i])) unknown.push_back(i);
                } else if (slot != CellTable::kNone) {
                    accumulator.add(slot, batch, i);
                }
            }
            accumulator.flush();
        };
        const auto add_unknown = [&] {
            const CellTable::Admission admission(table, unknown.size());
            for (const std::uint64_t i : unknown) {
                const CellKey key = grid.key(lattice.encode(batch.positions[i]));
                accumulator.add(table.find_or_insert(key), batch, i);
            }
            accumulator.flush();
            unknown.clear();
        };
        while (source.next_vertices(batch)) {
            const std::uint64_t n = batch.positions.size();
            for (std::uint64_t i = 0; i < n; i += n_admitted) {
                add_known(i, std::min(n, i + n_admitted));
                if (!unknown.empty()) add_unknown();
            }
            context.advance(n);
        }
        n_bad_weights.fetch_add(accumulator.n_bad_weights(), std::memory_order_relaxed);
    });
    return n_bad_weights;
}

}  // namespace hewer::cluster
