// SPDX-License-Identifier: MIT
#include "rsimp/aggregate_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "hewer/error.h"
#include "ooc/disjoint_sets.h"
#include "ooc/external_sort.h"
#include "ooc/spool_cache.h"
#include "ooc/vec3.h"
#include "rsimp/cell_mean.h"
#include "rsimp/cell_neighbours.h"
#include "rsimp/cell_parts.h"
#include "rsimp/cell_selection.h"
#include "rsimp/cluster_summary.h"
#include "rsimp/facing_walls.h"
#include "rsimp/grid_choice.h"
#include "rsimp/part_contacts.h"

namespace hewer::rsimp {

namespace {

using cluster::CellAttributes;
using cluster::CellBlocks;
using cluster::CellRecord;
using cluster::CellTriple;

/// A cell and the set of cells that it is merged with.
struct Member {
    std::uint32_t set;
    std::uint32_t cell;
    std::uint32_t part;
    Vec3 mean;
};
bool is_before(const Member& a, const Member& b) {
    return std::tie(a.set, a.cell) < std::tie(b.set, b.cell);
}

struct MergedCell {
    std::uint32_t cell;
    CellRecord record;
    CellAttributes attributes;
};
bool is_lower(const MergedCell& a, const MergedCell& b) {
    return a.cell < b.cell;
}

/// Merges sets of cells: which one stays, and what it stands for.
class CellMerger {
  public:
    CellMerger(ooc::Context& context, const CellBlocks& cells)
        : records_(cells.cells),
          target_(context.budget(), "cells that others are merged with", cells.n_cells()) {
        if (!cells.attributes.empty()) attributes_.emplace(cells.attributes);
        for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
            target_[i] = static_cast<std::uint32_t>(i);
        }
    }

    MergedCell merge(const std::vector<Member>& members) {
        Vec3 middle{};
        for (const Member& m : members) middle = middle + m.mean;
        middle = (1 / static_cast<double>(members.size())) * middle;
        const Member* kept = members.data();
        const auto squared = [](const Vec3& a, const Vec3& b) {
            const Vec3 d = a - b;
            return dot(d, d);
        };
        for (const Member& m : members) {
            if (squared(m.mean, middle) < squared(kept->mean, middle)) kept = &m;
        }
        MergedCell merged{kept->cell, records_.at(kept->cell), {}};
        // Quadrics are relative to each cell's mean; the frame is the mean of the one that stays.
        cluster::Quadric sum;
        double area = 0;
        for (const Member& m : members) {
            target_[m.cell] = kept->cell;
            const CellRecord record = records_.at(m.cell);
            cluster::Quadric q;
            for (std::size_t i = 0; i < 6; ++i) q.a[i] = static_cast<double>(record.quadric[i]);
            for (std::size_t i = 0; i < 3; ++i) q.b[i] = static_cast<double>(record.quadric[6 + i]);
            q.c = static_cast<double>(record.quadric[9]);
            sum += q.relative_to(kept->mean - m.mean);
            area += static_cast<double>(record.area);
            merged.record.flags |= record.flags & CellRecord::kHasBorder;
            if (attributes_) merged.attributes += attributes_->at(m.cell);
            farthest_ = std::max(farthest_, squared(m.mean, kept->mean));
        }
        for (std::size_t i = 0; i < 6; ++i) {
            merged.record.quadric[i] = static_cast<float>(sum.a[i]);
        }
        for (std::size_t i = 0; i < 3; ++i) {
            merged.record.quadric[6 + i] = static_cast<float>(sum.b[i]);
        }
        merged.record.quadric[9] = static_cast<float>(sum.c);
        merged.record.area = static_cast<float>(area);
        return merged;
    }

    [[nodiscard]] std::uint32_t target(std::uint32_t cell) const { return target_[cell]; }
    [[nodiscard]] double farthest() const { return std::sqrt(farthest_); }

  private:
    ooc::SpoolCache<CellRecord> records_;
    std::optional<ooc::SpoolCache<CellAttributes>> attributes_;
    ooc::Array<std::uint32_t> target_;
    double farthest_ = 0;  // squared, in cells
};

/// The parts that have a cell in each of the merged ones, and where these are. Memory: 4 bytes a
/// member and 32 a set.
class PartsOfSets {
  public:
    PartsOfSets(ooc::Context& context, const ooc::Spool<Member>& members, const CellMerger& merger)
        : parts_(context.budget(), "parts of merged cells", members.size()) {
        std::uint64_t n_sets = 0;
        {
            ooc::SpoolReader<Member> reader(members);
            std::uint32_t last = kNoPart;
            for (std::uint64_t i = 0; i < members.size(); ++i) {
                const Member& m = *reader.next();
                parts_[i] = m.part;
                if (i == 0 || m.set != last) ++n_sets;
                last = m.set;
            }
        }
        sets_ = ooc::Array<Set>(context.budget(), "sets of merged cells", n_sets + 1);
        ooc::SpoolReader<Member> reader(members);
        std::uint64_t n = 0;
        std::uint32_t last = kNoPart;
        for (std::uint64_t i = 0; i < members.size(); ++i) {
            const Member& m = *reader.next();
            if (i == 0 || m.set != last) sets_[n++] = {merger.target(m.cell), i, {}};
            last = m.set;
            if (m.cell == sets_[n - 1].cell) sets_[n - 1].mean = m.mean;
        }
        sets_[n] = {kNoPart, members.size(), {}};
        for (std::uint64_t s = 0; s < n; ++s) {
            std::sort(parts_.begin() + sets_[s].first, parts_.begin() + sets_[s + 1].first);
            sets_[s].n = sets_[s + 1].first - sets_[s].first;
        }
        std::sort(sets_.begin(), sets_.begin() + n,
                  [](const Set& a, const Set& b) { return a.cell < b.cell; });
    }

    struct Set {
        std::uint32_t cell;  // that stays
        std::uint64_t first;
        Vec3 mean;
        std::uint64_t n = 0;
    };
    /// Nothing if nothing was merged with `cell`.
    [[nodiscard]] const Set* find(std::uint32_t cell) const {
        const Set* const end = sets_.end() - 1;
        const Set* const at = std::lower_bound(
            sets_.begin(), end, cell, [](const Set& s, std::uint32_t c) { return s.cell < c; });
        return at != end && at->cell == cell ? at : nullptr;
    }
    /// The first part but `own` that all of the sets have a cell of; kNoPart if there is none.
    [[nodiscard]] std::uint32_t common_part(const std::array<const Set*, 3>& sets,
                                            std::uint32_t own) const {
        const auto has = [&](const Set& s, std::uint32_t part) {
            return std::binary_search(parts_.begin() + s.first, parts_.begin() + s.first + s.n,
                                      part);
        };
        for (std::uint64_t i = 0; i < sets[0]->n; ++i) {
            const std::uint32_t part = parts_[sets[0]->first + i];
            if (part != own && has(*sets[1], part) && has(*sets[2], part)) return part;
        }
        return kNoPart;
    }

  private:
    ooc::Array<std::uint32_t> parts_;
    ooc::Array<Set> sets_;
};

/// A face of one of two parts all of whose corners both have a cell in.
struct FacingFace {
    std::uint32_t part;
    std::uint32_t other;  // the larger one
    WallFace face;
};
bool is_before_facing(const FacingFace& a, const FacingFace& b) {
    return std::tie(a.part, a.other, a.face.cells) < std::tie(b.part, b.other, b.face.cells);
}

/// keep(cells) for the faces that kept_walls() keeps of each two parts.
template <typename Keep>
void settle_walls(ooc::Context& context, const ooc::Spool<FacingFace>& facing, double distance,
                  const Keep& keep) {
    constexpr std::uint64_t kBytesPerFace = 300;
    ooc::SpoolReader<FacingFace> reader(facing);
    std::vector<WallFace> faces;
    while (reader.peek() != nullptr) {
        const FacingFace first = *reader.peek();
        faces.clear();
        while (reader.peek() != nullptr && reader.peek()->part == first.part &&
               reader.peek()->other == first.other) {
            faces.push_back(reader.next()->face);
        }
        const ooc::Reservation bytes =
            context.budget().reserve("walls of two parts", kBytesPerFace * faces.size());
        const std::vector<bool> is_kept = kept_walls(faces, distance);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            if (is_kept[f]) keep(faces[f].cells);
        }
        context.check_stop();
    }
}

/// Faces whose corners stay keep their order; the others find their new blocks by sorting, bar
/// walls that face each other.
void copy_faces(ooc::Context& context, CellBlocks& from, const CellMerger& merger,
                const ooc::RankedSet& kept, const PartsOfSets& sets,
                const ooc::Spool<std::uint32_t>& names, double distance, CellBlocks& to) {
    struct Moved {
        std::uint32_t middle;
        CellTriple face;
    };
    const auto is_before = [](const Moved& a, const Moved& b) {
        return a.middle != b.middle ? a.middle < b.middle : a.face < b.face;
    };
    const auto in_block = [&](std::uint32_t cell, std::size_t block) {
        return cell < to.blocks[block + 1].first_cell;
    };
    ooc::ExternalSorter<Moved, decltype(is_before)> sorter(context, "faces of merged cells",
                                                           is_before, context.sort_bytes());
    ooc::Spool<CellTriple> others(context, "faces of other cells");
    ooc::ExternalSorter<FacingFace, decltype(&is_before_facing)> facing(
        context, "walls that face each other", &is_before_facing, context.sort_bytes());
    ooc::SpoolCache<std::uint32_t> part_of(names);
    const auto add_moved = [&](const CellTriple& face, CellTriple mapped) {
        std::array<const PartsOfSets::Set*, 3> merged{};
        for (std::size_t k = 0; k < 3; ++k) merged[k] = sets.find(merger.target(face[k]));
        if (merged[0] != nullptr && merged[1] != nullptr && merged[2] != nullptr) {
            const std::uint32_t own = part_of.at(face[0]);
            const std::uint32_t other = sets.common_part(merged, own);
            if (other != kNoPart) {
                facing.add({std::min(own, other),
                            std::max(own, other),
                            {mapped, {merged[0]->mean, merged[1]->mean, merged[2]->mean}}});
                return;
            }
        }
        sorter.add({cluster::median_corner(mapped), mapped});
    };
    ooc::SpoolReader<CellTriple> faces(from.faces);
    while (const CellTriple* face = faces.next()) {
        CellTriple mapped;
        bool is_moved = false;
        for (std::size_t k = 0; k < 3; ++k) {
            mapped[k] = static_cast<std::uint32_t>(kept.rank(merger.target((*face)[k])));
            is_moved |= merger.target((*face)[k]) != (*face)[k];
        }
        if (mapped[0] == mapped[1] || mapped[1] == mapped[2] || mapped[0] == mapped[2]) continue;
        if (is_moved || sets.find((*face)[0]) != nullptr) {
            add_moved(*face, mapped);
        } else {
            others.push(mapped);
        }
        constexpr std::uint64_t kBetween = 1 << 16;
        if (faces.position() % kBetween != 0) continue;
        from.faces.discard_before(faces.position());
        context.check_stop();
    }
    settle_walls(context, facing.finish(), distance, [&](const CellTriple& cells) {
        sorter.add({cluster::median_corner(cells), cells});
    });
    const ooc::Spool<Moved> moved = sorter.finish();
    ooc::SpoolReader<CellTriple> still(others);
    ooc::SpoolReader<Moved> sorted(moved);
    for (std::size_t b = 0; b + 1 < to.blocks.size(); ++b) {
        to.blocks[b].first_face = to.faces.size();
        while (still.peek() != nullptr && in_block(cluster::median_corner(*still.peek()), b)) {
            to.faces.push(*still.next());
        }
        while (sorted.peek() != nullptr && in_block(sorted.peek()->middle, b)) {
            to.faces.push(sorted.next()->face);
        }
    }
    to.blocks.back().first_face = to.faces.size();
}

/// Distinct parts among the pieces of cells with a face.
std::uint64_t count_parts(ooc::Context& context, const CellBlocks& cells, CellParts& parts,
                          ooc::DisjointSets& joined, std::uint64_t& n_joined) {
    ooc::Array<std::uint64_t> seen(context.budget(), "parts of the model",
                                   parts.n_pieces() / 32 + 1);
    const FacedCells faced(context, cells);
    std::uint64_t n = 0;
    n_joined = 0;
    // Two bits for each piece: whether its part, and its joined part, was counted.
    const auto mark = [&](std::uint64_t i, unsigned bit) {
        std::uint64_t& word = seen[i / 32];
        const std::uint64_t mask = std::uint64_t{1} << (2 * (i % 32) + bit);
        const bool is_new = (word & mask) == 0;
        word |= mask;
        return is_new;
    };
    ooc::SpoolReader<std::uint32_t> pieces(parts.pieces());
    for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
        const std::uint32_t piece = *pieces.next();
        if (!faced.has(i)) continue;
        const std::uint64_t part = parts.part_of(piece);
        if (!mark(part, 0)) continue;
        ++n;
        if (mark(joined.find(part), 1)) ++n_joined;
    }
    return n;
}

}  // namespace

CellBlocks aggregate_parts(ooc::Context& context, CellBlocks cells, const SimplifyOptions& options,
                           SimplifyReport& report, std::uint64_t most_cells) {
    if (!options.aggregate) return cells;
    AggregateReport& told = report.aggregate.emplace();
    const double cell_size = cells.grid.cell_size(cells.lattice);
    const double distance = target_error(*options.aggregate, report.input.bounds) / cell_size;
    ooc::Spool<Member> members;
    ooc::Spool<std::uint32_t> names;
    CellMerger merger(context, cells);
    {
        CellParts parts(context, cells);
        ooc::DisjointSets sets(context.budget(), "cells that are merged", cells.n_cells());
        ooc::DisjointSets joined(context.budget(), "parts that are joined", parts.n_pieces());
        ooc::Spool<Contact> contacts(context, "close cells of different parts");
        names = find_contacts(context, cells, parts, distance,
                              [&](const Contact& c, std::uint32_t other_part) {
                                  contacts.push(c);
                                  sets.join(c.cell, c.other);
                                  joined.join(c.part, other_part);
                              });
        told.parts = count_parts(context, cells, parts, joined, told.joined_parts);
        if (contacts.empty()) return cells;
        ooc::ExternalSorter<Member, decltype(&is_before)> sorter(context, "merged cells",
                                                                 &is_before, context.sort_bytes());
        ooc::SpoolReader<Contact> reader(contacts);
        std::uint32_t last = kNoPart;
        while (const Contact* c = reader.next()) {
            if (c->cell == std::exchange(last, c->cell)) continue;
            sorter.add({static_cast<std::uint32_t>(sets.find(c->cell)), c->cell, c->part, c->mean});
        }
        members = sorter.finish();
    }
    ooc::ExternalSorter<MergedCell, decltype(&is_lower)> sorter(context, "merged cells", &is_lower,
                                                                context.sort_bytes());
    {
        ooc::SpoolReader<Member> reader(members);
        std::vector<Member> set;
        while (reader.peek() != nullptr) {
            set.assign(1, *reader.next());
            while (reader.peek() != nullptr && reader.peek()->set == set[0].set) {
                set.push_back(*reader.next());
            }
            told.merged_cells += set.size() - 1;
            sorter.add(merger.merge(set));
            context.check_stop();
        }
    }
    told.distance = cell_size * merger.farthest();
    const ooc::Spool<MergedCell> merged = sorter.finish();
    ooc::RankedSet kept(context.budget(), "cells that stay", cells.n_cells());
    for (std::uint64_t i = 0; i < cells.n_cells(); ++i) {
        if (merger.target(static_cast<std::uint32_t>(i)) == i) kept.insert(i);
    }
    kept.number();
    CellBlocks result =
        cluster::make_cell_blocks(context, cells.lattice, cells.grid, !cells.attributes.empty());
    result.is_consistently_wound = cells.is_consistently_wound;
    {
        ooc::SpoolReader<MergedCell> reader(merged);
        copy_cells(
            context, cells, kept,
            [&](std::uint64_t cell, CellRecord& record, CellAttributes* attributes) {
                if (reader.peek() == nullptr || reader.peek()->cell != cell) return;
                const MergedCell& other = *reader.next();
                record = other.record;
                if (attributes != nullptr) *attributes = other.attributes;
            },
            most_cells, result);
    }
    copy_borders(cells, kept, result);
    copy_faces(context, cells, merger, kept, PartsOfSets(context, members, merger), names, distance,
               result);
    return result;
}

}  // namespace hewer::rsimp
