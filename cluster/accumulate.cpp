// SPDX-License-Identifier: MIT
#include "cluster/accumulate.h"

#include <atomic>
#include <map>
#include <mutex>
#include <optional>

#include "cluster/four_triangles.h"
#include "cluster/hash.h"
#include "ooc/parallel.h"
#include "ooc/vector_clones.h"

namespace hewer::cluster {

std::pair<ooc::Array<CellTriple>, std::uint64_t> TripleList::pop_piece() {
    if (pieces_.empty()) return {};
    std::pair<ooc::Array<CellTriple>, std::uint64_t> last{std::move(pieces_.back()), used_};
    pieces_.pop_back();
    used_ = kPiece;
    if (counter_ != nullptr) counter_->fetch_sub(1, std::memory_order_relaxed);
    return last;
}

namespace {

// Areas add up as integers too: the report must not depend on the order of the batches.
constexpr double kAreaScale = 1024;

/// One worker's view of the pass.
class Accumulator {
  public:
    Accumulator(ooc::Context& context, const UniformGrid& grid, CellTable& table,
                TripleList& triples, bool with_face_normals)
        : budget_(context.budget()),
          grid_(grid),
          fixed_(grid.resolution()),
          table_(table),
          triples_(triples),
          with_face_normals_(with_face_normals),
          is_shared_(context.n_threads() > 1) {}

    /// Where corner v of the next triangle belongs. Not handed over to add(): a corner that is
    /// copied as a whole right after its parts were written stalls.
    PlacedPoint& corner(std::size_t v) { return waiting_[v][n_waiting_]; }
    /// Adds the triangle whose corners are in place.
    void add() {
        if (++n_waiting_ == 4) add_waiting();
    }

    void flush() {
        if (n_waiting_ > 0) add_waiting();
        for (Pending& pending : pending_) empty(pending);
    }

    std::uint64_t n_triangles = 0;
    std::uint64_t n_degenerate = 0;
    std::int64_t area_units = 0;

  private:
    struct Pending {
        std::uint32_t cell = CellTable::kNone;
        CellContribution sums{};
    };
    HEWER_INLINE void empty(Pending& pending) noexcept {
        if (pending.cell == CellTable::kNone) return;
        pending.sums.add_to(table_.sums(pending.cell), is_shared_);
        pending.cell = CellTable::kNone;
        pending.sums.clear();
    }
    /// They are needed when the cell has been left.
    HEWER_INLINE static void prefetch(const CellSums& sums) noexcept {
        constexpr std::size_t kLine = 64;
        const auto* const bytes = reinterpret_cast<const char*>(&sums);
        for (std::size_t at = 0; at < sizeof sums; at += kLine) __builtin_prefetch(bytes + at, 1);
    }
    HEWER_INLINE CellContribution& sums_of(std::uint32_t cell) noexcept {
        Pending& pending = pending_[cell % kPending];
        if (pending.cell != cell) {
            empty(pending);
            pending.cell = cell;
            prefetch(table_.sums(cell));
        }
        return pending.sums;
    }

    void add_waiting() {
        add_to_cells();
        for (std::size_t i = 0; i < n_waiting_; ++i) {
            const CellTriple triple = {waiting_[0][i].cell, waiting_[1][i].cell,
                                       waiting_[2][i].cell};
            if (triple[0] != triple[1] && triple[1] != triple[2] && triple[0] != triple[2]) {
                triples_.push(budget_, triple);
            }
        }
        n_triangles += n_waiting_;
        n_waiting_ = 0;
    }
    /// Must not throw: GCC takes callers of clones for callers of functions that never do, and an
    /// exception would end the process. Lanes beyond n_waiting_ have triangles of before.
    HEWER_VECTOR_CLONES void add_to_cells() noexcept {
        const FourTriangles triangles(waiting_, grid_, fixed_);
        Ints areas;
        round_to_ints(triangles.area * kAreaScale, areas);
        bool is_all_inside = true;
        for (std::size_t i = 0; i < n_waiting_; ++i) {
            area_units += areas[i];
            if (triangles.is_flat[i] != 0) ++n_degenerate;
            is_all_inside &= triangles.is_inside[i] != 0;
        }
        std::array<CellContribution, 4> contributions;
        const std::size_t n_corners = is_all_inside ? 1 : 3;
        for (std::size_t v = 0; v < n_corners; ++v) {
            triangles.contribute(v, contributions);
            for (std::size_t i = 0; i < n_waiting_; ++i) {
                if (v > 0 && triangles.is_inside[i] != 0) continue;
                sums_of(waiting_[v][i].cell).add(contributions[i]);
                if (with_face_normals_) add_face_normal(waiting_[v][i].cell, triangles, i);
            }
        }
    }
    HEWER_INLINE void add_face_normal(std::uint32_t cell, const FourTriangles& triangles,
                                      std::size_t i) {
        AttributeSums& sums = table_.attributes(cell);
        std::uint32_t unshared = 0;
        const FieldLock lock(is_shared_ ? table_.sums(cell).lock : unshared);
        for (std::size_t k = 0; k < 3; ++k) {
            sums.face_normal[k] +=
                round_to_int(triangles.share[i] * triangles.normal[k][i] * fixed_.scale);
        }
    }

    ooc::MemoryBudget& budget_;
    const UniformGrid& grid_;
    FixedPoint fixed_;
    CellTable& table_;
    TripleList& triples_;
    bool with_face_normals_;
    bool is_shared_;
    FourCorners waiting_{};
    std::size_t n_waiting_ = 0;
    // The cells of a triangle are mostly those of the ones before: they are added up here first.
    static constexpr std::uint32_t kPending = 64;
    std::array<Pending, kPending> pending_;
};

/// One worker's memory of the cells that it has met last, in front of the table that is too large
/// for a core's cache: vertices that follow each other are in cells near each other.
class RecentCells {
  public:
    explicit RecentCells(CellTable& table) : table_(table) {}

    /// Under an Admission, after begin().
    std::uint32_t find_or_insert(CellKey key) {
        Recent& recent = recent_[scattered(key) % kRecent];
        if (recent.key != key) recent = {key, table_.find_or_insert(key)};
        return recent.slot;
    }
    /// At the beginning of each Admission: slots of another epoch mean nothing.
    void begin() {
        if (std::exchange(epoch_, table_.epoch()) != table_.epoch()) recent_.fill({});
    }

  private:
    static constexpr std::size_t kRecent = 512;
    struct Recent {
        CellKey key = ~CellKey{0};  // no key: keys have 63 bits
        std::uint32_t slot = 0;
    };
    CellTable& table_;
    std::uint64_t epoch_ = 0;
    std::array<Recent, kRecent> recent_{};
};

/// One worker's way from a batch of triangles to corners with cells.
class CornerFinder {
  public:
    CornerFinder(const AccumulateInput& input, CellTable& table)
        : input_(input), table_(table), recent_(table) {
        if (input.vertices != nullptr) view_.emplace(*input.vertices);
    }

    /// All triangles of the batch go to `accumulator`. Returns how many were left out because a
    /// vertex is not finite.
    std::uint64_t add_all(const TriangleBatch& batch, Accumulator& accumulator) {
        if (input_.most_spills && table_.epoch() > *input_.most_spills) throw Incoherent();
        if (input_.most_spills && input_.vertices != nullptr) {
            n_seen_ += batch.corners.size();
            if (input_.vertices->is_thrashing(n_seen_)) throw Incoherent();
        }
        const std::uint64_t n_admitted = table_.share() / 3;
        std::uint64_t n_left_out = 0;
        for (std::size_t k = 0; k < batch.corners.size();) {
            const std::size_t end = std::min<std::size_t>(batch.corners.size(), k + n_admitted);
            const CellTable::Admission admission(table_, 3 * (end - k));
            recent_.begin();
            for (; k < end && !view_->is_full(); ++k) {
                bool is_usable = true;
                for (std::size_t c = 0; c < 3; ++c) {
                    is_usable &= find(batch.corners[k][c], accumulator.corner(c));
                }
                if (is_usable) {
                    accumulator.add();
                } else {
                    ++n_left_out;
                }
            }
            // The table may grow or spill now, never under a run.
            accumulator.flush();
            view_->release();
        }
        for (std::size_t i = 0; i < batch.points.size(); i += n_admitted) {
            const std::size_t end = std::min<std::size_t>(batch.points.size(), i + n_admitted);
            const CellTable::Admission admission(table_, 3 * (end - i));
            recent_.begin();
            for (std::size_t k = i; k < end; ++k) {
                for (std::size_t c = 0; c < 3; ++c) {
                    accumulator.corner(c) = locate(batch.points[k][c]);
                }
                accumulator.add();
            }
            accumulator.flush();
        }
        return n_left_out;
    }

  private:
    bool find(std::uint64_t v, PlacedPoint& corner) {
        PlacedPoint& vertex = view_->vertex(v);
        // Two workers may look the same vertex up at once: they find the same slot.
        const std::atomic_ref<std::uint32_t> slot(vertex.cell);
        corner.cell = slot.load(std::memory_order_relaxed);
        if (corner.cell == CellTable::kNone) return false;
        corner.point = vertex.point;
        if (corner.cell == VertexPages::kUnknown) {
            corner.cell = cell_of(corner.point);
            slot.store(corner.cell, std::memory_order_relaxed);
        }
        return true;
    }
    PlacedPoint locate(const Vec3& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            if (!(p[k] >= input_.bounds.min[k] && p[k] <= input_.bounds.max[k])) {
                throw_outside_bounds(input_.source, "a triangle");
            }
        }
        const LatticePoint point = input_.lattice.encode(p);
        return {point, cell_of(point)};
    }
    std::uint32_t cell_of(const LatticePoint& point) {
        return recent_.find_or_insert(input_.grid.key(point));
    }

    const AccumulateInput& input_;
    CellTable& table_;
    RecentCells recent_;
    std::optional<VertexPages::View> view_;
    std::uint64_t n_seen_ = 0;  // triangles, by this worker
};

}  // namespace

AccumulateResult accumulate(ooc::Context& context, const AccumulateInput& input, CellTable& table,
                            std::vector<TripleList>& triples, bool with_face_normals) {
    AccumulateResult result;
    std::mutex mutex;
    std::map<std::uint64_t, InputDefects> defects_by_place;
    std::int64_t area_units = 0;
    std::uint64_t n_degenerate = 0;

    input.source.begin_triangles();
    context.workers().on_each([&](unsigned worker) {
        Accumulator accumulator(context, input.grid, table, triples[worker], with_face_normals);
        CornerFinder finder(input, table);
        TriangleBatch batch;
        while (input.source.next_triangles(batch)) {
            batch.defects.nonfinite_triangles += finder.add_all(batch, accumulator);
            context.advance(batch.n_faces);
            const std::lock_guard lock(mutex);
            const InputDefects& d = batch.defects;
            if (d.nonfinite_triangles + d.out_of_range_triangles + d.short_faces + d.polygons +
                    d.trailing_bytes >
                0) {
                defects_by_place[batch.first_face] = d;
            }
        }
        const std::lock_guard lock(mutex);
        result.n_triangles += accumulator.n_triangles;
        n_degenerate += accumulator.n_degenerate;
        area_units += accumulator.area_units;
    });

    for (const auto& [place, defects] : defects_by_place) result.defects.merge(defects);
    result.defects.degenerate_triangles += n_degenerate;
    const double cell = input.grid.cell_size(input.lattice);
    result.area = static_cast<double>(area_units) / kAreaScale * cell * cell;
    return result;
}

AccumulateResult accumulate(ooc::Context& context, TrianglePartition& partition,
                            const Lattice& lattice, const UniformGrid& grid, CellTable& table,
                            std::vector<TripleList>& triples, bool with_face_normals) {
    AccumulateResult result;
    std::mutex mutex;
    std::int64_t area_units = 0;
    context.workers().on_each([&](unsigned worker) {
        Accumulator accumulator(context, grid, table, triples[worker], with_face_normals);
        std::vector<LatticeTriangle> points;
        const std::uint64_t n_admitted = table.share() / 3;
        while (partition.next(points)) {
            for (std::size_t i = 0; i < points.size(); i += n_admitted) {
                const std::size_t end = std::min<std::size_t>(points.size(), i + n_admitted);
                const CellTable::Admission admission(table, 3 * (end - i));
                for (std::size_t k = i; k < end; ++k) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        accumulator.corner(c) = {points[k][c],
                                                 table.find_or_insert(grid.key(points[k][c]))};
                    }
                    accumulator.add();
                }
                accumulator.flush();
            }
            context.check_stop();
        }
        const std::lock_guard lock(mutex);
        result.n_triangles += accumulator.n_triangles;
        result.defects.degenerate_triangles += accumulator.n_degenerate;
        area_units += accumulator.area_units;
    });
    const double cell = grid.cell_size(lattice);
    result.area = static_cast<double>(area_units) / kAreaScale * cell * cell;
    return result;
}

}  // namespace hewer::cluster
