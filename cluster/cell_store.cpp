// SPDX-License-Identifier: MIT
#include "cluster/cell_store.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "ooc/parallel.h"
#include "ooc/radix_sort.h"

namespace hewer::cluster {

namespace {

struct CodedSlot {
    std::uint64_t code;
    std::uint32_t slot;
    std::uint32_t unused;
};

// More border cells than this share: neighbouring triangles disagree about their winding, and the
// sums that should cancel do not.
constexpr double kMostBorderCells = 0.5;
constexpr std::uint64_t kLeastCellsToJudge = 1000;
constexpr double kVertexNormalScale = 1 << 20;

bool has_border(const CellSums& sums) {
    return std::any_of(sums.border.begin(), sums.border.end(),
                       [](std::uint32_t x) { return x != 0; });
}

/// The squared distance to the border line through the cell, weighted with the squared length of
/// its chord: |x X E - M|^2 with chord E and moment M = p X E.
Quadric border_quadric(const CellSums& sums, const FixedPoint& fixed) {
    // Every border edge was seen from both of its ends: half of the sum is the chord.
    const double unit = std::ldexp(0.5, -static_cast<int>(fixed.border_bits));
    const auto value = [&](std::size_t i) {
        return static_cast<double>(static_cast<std::int32_t>(sums.border[i]));
    };
    const Vec3 e{value(0) * unit, value(1) * unit, value(2) * unit};
    const double unit_moment = unit * std::ldexp(1.0, -static_cast<int>(fixed.border_bits));
    const Vec3 m{value(3) * unit_moment, value(4) * unit_moment, value(5) * unit_moment};
    const double ee = dot(e, e);
    Quadric q;
    if (!(ee > 0)) return q;  // a hole inside one cell: nothing to hold on to
    q.a = {ee - e[0] * e[0], -e[0] * e[1], -e[0] * e[2],
           ee - e[1] * e[1], -e[1] * e[2], ee - e[2] * e[2]};
    q.b = -1.0 * cross(e, m);
    q.c = dot(m, m);
    return q;
}

CellRecord make_record(const CellSums& sums, const FixedPoint& fixed, double border_weight) {
    const double unit = 1 / fixed.scale;
    const auto value = [&](std::size_t i) { return static_cast<double>(sums.surface[i]) * unit; };
    Quadric q;
    for (std::size_t i = 0; i < 6; ++i) q.a[i] = value(i);
    for (std::size_t i = 0; i < 3; ++i) q.b[i] = value(6 + i);
    q.c = value(9);
    const double area = q.trace();
    Vec3 mean{};
    if (area > 0) {
        for (std::size_t i = 0; i < 3; ++i) {
            mean[i] =
                std::clamp(value(10 + i) / area, -CellRecord::kMostOffset, CellRecord::kMostOffset);
        }
    }
    CellRecord record{};
    record.flags = has_border(sums) ? CellRecord::kHasBorder : 0;
    if (record.flags != 0 && border_weight > 0) {
        const Quadric border = border_quadric(sums, fixed);
        for (std::size_t i = 0; i < 6; ++i) q.a[i] += border_weight * border.a[i];
        for (std::size_t i = 0; i < 3; ++i) q.b[i] += border_weight * border.b[i];
        q.c += border_weight * border.c;
    }
    q = q.relative_to(mean);
    for (std::size_t i = 0; i < 6; ++i) record.quadric[i] = static_cast<float>(q.a[i]);
    for (std::size_t i = 0; i < 3; ++i) record.quadric[6 + i] = static_cast<float>(q.b[i]);
    record.quadric[9] = static_cast<float>(std::max(0.0, q.c));
    for (std::size_t i = 0; i < 3; ++i) record.mean[i] = static_cast<float>(mean[i]);
    record.area = static_cast<float>(area);
    return record;
}

CellAttributes make_attributes(const AttributeSums& sums, const FixedPoint& fixed) {
    CellAttributes a{};
    for (std::size_t i = 0; i < 3; ++i) {
        a.normal[i] = static_cast<float>(static_cast<double>(sums.normal[i]) / kVertexNormalScale);
        a.face_normal[i] =
            static_cast<float>(static_cast<double>(sums.face_normal[i]) / fixed.scale);
    }
    for (std::size_t i = 0; i < 4; ++i) a.color[i] = static_cast<float>(sums.color[i]);
    a.n_colors = static_cast<float>(sums.n_colors);
    return a;
}

void renumber(ooc::Context& context, const ooc::Array<std::uint32_t>& rank,
              std::vector<TripleList>& triples, CellStore& store) {
    std::uint64_t n = 0;
    for (const TripleList& list : triples) n += list.size();
    store.triangles = {context.budget(), "surviving triangles", n};
    std::uint64_t at = 0;
    for (TripleList& list : triples) {
        for (;;) {
            const auto [piece, used] = list.pop_piece();
            if (used == 0) break;
            const std::uint64_t first = at;
            const auto& source = piece;
            context.workers().for_ranges(used, 1 << 13, [&](std::uint64_t b, std::uint64_t e) {
                for (std::uint64_t i = b; i < e; ++i) {
                    for (std::size_t k = 0; k < 3; ++k) {
                        store.triangles[first + i][k] = rank[source[i][k]];
                    }
                }
            });
            at += used;
        }
    }
}

}  // namespace

CellStore build_cell_store(ooc::Context& context, const Lattice& lattice, const UniformGrid& grid,
                           CellTable& table, std::vector<TripleList>& triples,
                           double border_weight) {
    CellStore store;
    store.lattice = lattice;
    store.grid = grid;
    const FixedPoint fixed(grid.resolution());

    std::uint64_t n_cells = 0;
    table.for_each([&](CellKey, std::uint32_t slot) {
        const CellSums& sums = table.sums(slot);
        if (sums.is_touched == 0) return;
        ++n_cells;
        if (has_border(sums)) ++store.n_border_cells;
    });
    if (n_cells >= kLeastCellsToJudge && static_cast<double>(store.n_border_cells) >
                                             kMostBorderCells * static_cast<double>(n_cells)) {
        store.is_consistently_wound = false;
        border_weight = 0;
    }

    ooc::Array<CodedSlot> order(context.budget(), "cell order", n_cells);
    {
        std::uint64_t i = 0;
        table.for_each([&](CellKey key, std::uint32_t slot) {
            if (table.sums(slot).is_touched != 0) order[i++] = {morton(key), slot, 0};
        });
        const std::uint64_t n_slots = table.size();
        table.release_index();
        ooc::Array<CodedSlot> scratch(context.budget(), "cell order", n_cells);
        ooc::radix_sort(order, scratch, [](const CodedSlot& s) { return s.code; });
        scratch.release();

        store.codes = {context.budget(), "cell codes", n_cells};
        ooc::Array<std::uint32_t> rank(context.budget(), "cell ranks", n_slots);
        context.workers().for_ranges(n_cells, 1 << 13, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t k = begin; k < end; ++k) {
                store.codes[k] = order[k].code;
                rank[order[k].slot] = static_cast<std::uint32_t>(k);
            }
        });
        renumber(context, rank, triples, store);
    }

    store.cells = {context.budget(), "cells", n_cells};
    if (table.has_attributes()) store.attributes = {context.budget(), "cell attributes", n_cells};
    context.workers().for_ranges(n_cells, 1 << 13, [&](std::uint64_t begin, std::uint64_t end) {
        for (std::uint64_t k = begin; k < end; ++k) {
            const std::uint32_t slot = order[k].slot;
            store.cells[k] = make_record(table.sums(slot), fixed, border_weight);
            store.cells[k].id = static_cast<std::uint32_t>(k);
            if (table.has_attributes()) {
                store.attributes[k] = make_attributes(table.attributes(slot), fixed);
            }
        }
        context.check_stop();
    });
    context.workers().for_ranges(
        store.triangles.size(), 1 << 14, [&](std::uint64_t begin, std::uint64_t end) {
            for (std::uint64_t t = begin; t < end; ++t) {
                for (const std::uint32_t id : store.triangles[t]) {
                    std::atomic_ref<std::uint32_t> flags(store.cells[id].flags);
                    if ((flags.load(std::memory_order_relaxed) & CellRecord::kHasFace) == 0) {
                        flags.fetch_or(CellRecord::kHasFace, std::memory_order_relaxed);
                    }
                }
            }
        });
    return store;
}

}  // namespace hewer::cluster
