// SPDX-License-Identifier: MIT
#include "cluster/cell_runs.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "cluster/block_cutter.h"
#include "cluster/code_lookup.h"
#include "cluster/make_record.h"
#include "ooc/parallel.h"
#include "ooc/radix_sort.h"

namespace hewer::cluster {

namespace {

constexpr std::uint64_t kPiece = 1 << 12;
// Buffers of all runs that are merged take this part of the limit; but each at least so much.
constexpr std::uint64_t kBufferShare = 16;
constexpr std::uint64_t kLeastBufferBytes = 8 << 10;
constexpr std::uint64_t kLeastFanIn = 16;

struct CodedSlot {
    std::uint64_t code;
    std::uint32_t slot;
    std::uint32_t unused;
};

RunCell run_cell(std::uint64_t code, const CellSums& sums) {
    return {code, sums.surface, sums.border, sums.is_touched, 0};
}

/// All triples by rank, sorted by their median.
ooc::Array<CellTriple> sorted_triples(ooc::Context& context, const ooc::Array<std::uint32_t>& rank,
                                      std::vector<TripleList>& lists) {
    std::uint64_t n = 0;
    for (const TripleList& list : lists) n += list.size();
    ooc::Array<CellTriple> triples(context.budget(), "surviving triangles", n);
    std::uint64_t at = 0;
    for (TripleList& list : lists) {
        for (;;) {
            const auto [piece, used] = list.pop_piece();
            if (used == 0) break;
            for (std::uint64_t i = 0; i < used; ++i) {
                for (std::size_t k = 0; k < 3; ++k) triples[at][k] = rank[piece[i][k]];
                ++at;
            }
        }
    }
    ooc::Array<CellTriple> scratch(context.budget(), "surviving triangles", n);
    ooc::radix_sort(context.workers(), triples, scratch,
                    [](const CellTriple& t) { return median_corner(t); });
    return triples;
}

/// Reads several sorted runs as one: next() gives the reader whose record comes first.
template <typename T, typename Key>
class RunMerger {
  public:
    RunMerger(std::vector<ooc::SpoolReader<T>>& readers, Key key)
        : readers_(readers), key_(std::move(key)) {
        for (std::size_t r = 0; r < readers_.size(); ++r) {
            if (const T* record = readers_[r].peek()) heap_.push_back({key_(*record), r});
        }
        std::make_heap(heap_.begin(), heap_.end(), Later());
    }
    [[nodiscard]] bool empty() const { return heap_.empty(); }
    [[nodiscard]] std::uint64_t key() const { return heap_.front().key; }
    [[nodiscard]] std::size_t run() const { return heap_.front().run; }
    /// The record itself; valid until the next call.
    const T& take() {
        std::pop_heap(heap_.begin(), heap_.end(), Later());
        const std::size_t run = heap_.back().run;
        heap_.pop_back();
        record_ = *readers_[run].next();
        if (const T* following = readers_[run].peek()) {
            heap_.push_back({key_(*following), run});
            std::push_heap(heap_.begin(), heap_.end(), Later());
        }
        return record_;
    }

  private:
    struct Head {
        std::uint64_t key;
        std::size_t run;
    };
    struct Later {
        bool operator()(const Head& a, const Head& b) const {
            return a.key != b.key ? a.key > b.key : a.run > b.run;
        }
    };
    std::vector<ooc::SpoolReader<T>>& readers_;
    Key key_;
    std::vector<Head> heap_;
    T record_;
};

struct MedianCorner {
    std::uint64_t operator()(const CodeTriple& t) const { return median_corner(t); }
};

void add_to(CellSums& sums, const RunCell& part) {
    for (std::size_t i = 0; i < sums.surface.size(); ++i) sums.surface[i] += part.surface[i];
    for (std::size_t i = 0; i < sums.border.size(); ++i) sums.border[i] += part.border[i];
    sums.is_touched |= part.is_touched;
}

}  // namespace

// Two buffers a run with attributes, and two levels that are merged at once.
CellRuns::CellRuns(ooc::Context& context, CellExtras extras)
    : context_(context),
      extras_(extras),
      fan_in_(std::max<std::uint64_t>(
          kLeastFanIn, context.budget().limit() / kBufferShare / kLeastBufferBytes / 4)) {}

CellRuns::Level CellRuns::new_level() const {
    Level level;
    level.cells = {context_, "cell sums"};
    if (extras_.attributes) level.attributes = {context_, "attribute sums"};
    if (extras_.weights) level.weights = {context_, "weight sums"};
    level.triples = {context_, "surviving triangles"};
    level.ends = {{0, 0}};
    return level;
}

std::uint64_t CellRuns::n_runs() const {
    std::uint64_t n = 0;
    for (const Level& level : levels_) n += level.n_runs();
    return n;
}

std::uint64_t CellRuns::buffer_bytes(std::uint64_t n_runs) const {
    const std::uint64_t n_buffers = std::max<std::uint64_t>(1, n_runs) * (1 + extras_.count());
    return std::clamp<std::uint64_t>(context_.budget().limit() / kBufferShare / n_buffers,
                                     kLeastBufferBytes, ooc::SpoolReader<RunCell>::kBufferBytes);
}

void CellRuns::add(CellTable& table, std::vector<TripleList>& triples) {
    if (levels_.empty()) levels_.push_back(new_level());
    write_run(table, triples, levels_.front());
    for (std::size_t i = 0; levels_[i].n_runs() == fan_in_; ++i) {
        if (i + 1 == levels_.size()) levels_.push_back(new_level());
        std::vector<Level> full;
        full.push_back(std::exchange(levels_[i], new_level()));
        merge_into(levels_[i + 1], std::move(full));
    }
}

void CellRuns::write_run(CellTable& table, std::vector<TripleList>& triples, Level& level) const {
    const std::uint64_t n = table.size();
    ooc::Array<CodedSlot> order(context_.budget(), "cell order", n);
    std::uint64_t i = 0;
    table.for_each([&](CellKey key, std::uint32_t slot) { order[i++] = {morton(key), slot, 0}; });
    {
        ooc::Array<CodedSlot> scratch(context_.budget(), "cell order", n);
        ooc::radix_sort(context_.workers(), order, scratch,
                        [](const CodedSlot& s) { return s.code; });
    }
    {
        ooc::Array<std::uint32_t> rank(context_.budget(), "cell ranks", n);
        for (std::uint64_t k = 0; k < n; ++k) {
            rank[order[k].slot] = static_cast<std::uint32_t>(k);
        }
        const ooc::Array<CellTriple> sorted = sorted_triples(context_, rank, triples);
        std::vector<CodeTriple> piece;
        for (std::uint64_t first = 0; first < sorted.size(); first += kPiece) {
            piece.clear();
            for (std::uint64_t t = first; t < std::min(sorted.size(), first + kPiece); ++t) {
                piece.push_back(
                    {order[sorted[t][0]].code, order[sorted[t][1]].code, order[sorted[t][2]].code});
            }
            level.triples.append(piece);
        }
    }
    std::vector<RunCell> cells;
    std::vector<AttributeSums> attributes;
    std::vector<WeightSums> weights;
    for (std::uint64_t first = 0; first < n; first += kPiece) {
        cells.clear();
        attributes.clear();
        weights.clear();
        for (std::uint64_t k = first; k < std::min(n, first + kPiece); ++k) {
            const std::uint32_t slot = order[k].slot;
            cells.push_back(run_cell(order[k].code, table.sums(slot)));
            if (extras_.attributes) attributes.push_back(table.attributes(slot));
            if (extras_.weights) weights.push_back(table.weights(slot));
        }
        level.cells.append(cells);
        if (extras_.attributes) level.attributes.append(attributes);
        if (extras_.weights) level.weights.append(weights);
        context_.check_stop();
    }
    level.ends.push_back({level.cells.size(), level.triples.size()});
}

template <typename Visit>
void CellRuns::for_each_cell(const std::vector<Level>& levels, const Visit& visit) const {
    std::uint64_t n_runs = 0;
    for (const Level& level : levels) n_runs += level.n_runs();
    const std::uint64_t bytes = buffer_bytes(n_runs);
    const ooc::Reservation buffers =
        context_.budget().reserve("merging cells", n_runs * bytes * (1 + extras_.count()));
    std::vector<ooc::SpoolReader<RunCell>> readers;
    std::vector<ooc::SpoolReader<AttributeSums>> attribute_readers;
    std::vector<ooc::SpoolReader<WeightSums>> weight_readers;
    for (const Level& level : levels) {
        for (std::size_t r = 0; r < level.n_runs(); ++r) {
            const std::uint64_t first = level.ends[r].cell;
            const std::uint64_t last = level.ends[r + 1].cell;
            readers.emplace_back(level.cells, first, last, bytes);
            if (extras_.attributes) {
                attribute_readers.emplace_back(level.attributes, first, last, bytes);
            }
            if (extras_.weights) weight_readers.emplace_back(level.weights, first, last, bytes);
        }
    }
    const auto code_of = [](const RunCell& cell) { return cell.code; };
    RunMerger<RunCell, decltype(code_of)> merger(readers, code_of);
    std::uint64_t n_visited = 0;
    while (!merger.empty()) {
        const std::uint64_t code = merger.key();
        CellSums sums{};
        AttributeSums attribute_sums{};
        WeightSums weight_sums{};
        while (!merger.empty() && merger.key() == code) {
            if (extras_.attributes) attribute_sums += *attribute_readers[merger.run()].next();
            if (extras_.weights) weight_sums += *weight_readers[merger.run()].next();
            add_to(sums, merger.take());
        }
        visit(code, sums, attribute_sums, weight_sums);
        if (++n_visited % kPiece == 0) context_.check_stop();
    }
}

ooc::Reservation CellRuns::triple_readers(
    const std::vector<Level>& levels, std::vector<ooc::SpoolReader<CodeTriple>>& readers) const {
    std::uint64_t n_runs = 0;
    for (const Level& level : levels) n_runs += level.n_runs();
    const std::uint64_t bytes = buffer_bytes(n_runs);
    ooc::Reservation buffers = context_.budget().reserve("merging triangles", n_runs * bytes);
    for (const Level& level : levels) {
        for (std::size_t r = 0; r < level.n_runs(); ++r) {
            readers.emplace_back(level.triples, level.ends[r].triple, level.ends[r + 1].triple,
                                 bytes);
        }
    }
    return buffers;
}

void CellRuns::merge_into(Level& to, std::vector<Level> from) const {
    for_each_cell(from, [&](std::uint64_t code, const CellSums& sums,
                            const AttributeSums& attributes, const WeightSums& weights) {
        to.cells.push(run_cell(code, sums));
        if (extras_.attributes) to.attributes.push(attributes);
        if (extras_.weights) to.weights.push(weights);
    });
    for (Level& level : from) {
        level.cells.release();
        level.attributes.release();
        level.weights.release();
    }
    std::vector<ooc::SpoolReader<CodeTriple>> readers;
    const ooc::Reservation buffers = triple_readers(from, readers);
    RunMerger<CodeTriple, MedianCorner> merger(readers, {});
    for (std::uint64_t n = 0; !merger.empty(); ++n) {
        to.triples.push(merger.take());
        if (n % kPiece == 0) context_.check_stop();
    }
    to.ends.push_back({to.cells.size(), to.triples.size()});
}

void CellRuns::merge_cells(const std::vector<Level>& levels, double border_weight,
                           std::uint64_t most_cells, CellBlocks& blocks) const {
    const FixedPoint fixed(blocks.grid.resolution());
    BlockCutter cutter(blocks, most_cells);
    std::vector<std::uint64_t> codes;
    std::vector<CellRecord> cells;
    std::vector<CellAttributes> attributes;
    std::vector<float> weights;
    std::uint32_t n_cells = 0;
    const auto flush = [&] {
        cutter.add(codes);
        blocks.cells.append(cells);
        if (extras_.attributes) blocks.attributes.append(attributes);
        if (extras_.weights) blocks.weights.append(weights);
        codes.clear();
        cells.clear();
        attributes.clear();
        weights.clear();
    };
    for_each_cell(levels, [&](std::uint64_t code, const CellSums& sums,
                              const AttributeSums& attribute_sums, const WeightSums& weight_sums) {
        if (sums.is_touched == 0) return;
        if (has_border(sums)) ++blocks.n_border_cells;
        codes.push_back(code);
        cells.push_back(make_record(sums, fixed, border_weight));
        auto line = border_line(sums, fixed, cells.back(), center_of(code));
        if (line) {
            line->cell = n_cells;
            blocks.borders.push(*line);
        }
        ++n_cells;
        if (extras_.attributes) attributes.push_back(make_attributes(attribute_sums, fixed));
        if (extras_.weights) weights.push_back(make_weight(weight_sums));
        if (codes.size() == kPiece) flush();
    });
    flush();
    cutter.finish();
}

void CellRuns::merge_triples(const std::vector<Level>& levels, CellBlocks& blocks) const {
    std::vector<ooc::SpoolReader<CodeTriple>> readers;
    const ooc::Reservation buffers = triple_readers(levels, readers);
    RunMerger<CodeTriple, MedianCorner> merger(readers, {});
    // A few blocks at a time: read by one thread, mapped by all.
    const std::size_t n_at_once = 2 * context_.n_threads();
    const ooc::Reservation lookups = context_.budget().reserve(
        "codes of blocks", CellBlocks::kMostCells *
                               (context_.n_threads() * CodeLookup::kBlocks * sizeof(std::uint64_t) +
                                n_at_once * 2 * (sizeof(CodeTriple) + sizeof(CellTriple))));
    struct Work {
        std::vector<CodeTriple> codes;
        std::vector<CellTriple> ids;
    };
    for (std::size_t first = 0; first < blocks.n_blocks(); first += n_at_once) {
        const std::size_t last = std::min(blocks.n_blocks(), first + n_at_once);
        std::vector<Work> work(last - first);
        for (std::size_t b = first; b < last; ++b) {
            const std::uint64_t end =
                b + 1 < blocks.n_blocks() ? blocks.blocks[b + 1].box.code : ~std::uint64_t{0};
            while (!merger.empty() && merger.key() < end) {
                work[b - first].codes.push_back(merger.take());
            }
        }
        context_.workers().for_ranges(work.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
            CodeLookup lookup(blocks);
            for (std::uint64_t w = begin; w < end; ++w) {
                for (const CodeTriple& t : work[w].codes) {
                    work[w].ids.push_back(
                        {lookup.id_of(t[0]), lookup.id_of(t[1]), lookup.id_of(t[2])});
                }
            }
        });
        for (std::size_t b = first; b < last; ++b) {
            blocks.blocks[b].first_face = blocks.faces.size();
            blocks.faces.append(work[b - first].ids);
        }
        context_.check_stop();
    }
    blocks.blocks.back().first_face = blocks.faces.size();
}

CellBlocks CellRuns::merge(const Lattice& lattice, const UniformGrid& grid, double border_weight,
                           std::uint64_t most_cells) {
    std::vector<Level> levels = std::exchange(levels_, {});
    CellBlocks blocks = make_cell_blocks(context_, lattice, grid, extras_);
    merge_cells(levels, border_weight, most_cells, blocks);
    if (is_border_implausible(blocks.n_border_cells, blocks.n_cells())) {
        const std::uint64_t n_border_cells = blocks.n_border_cells;
        blocks = make_cell_blocks(context_, lattice, grid, extras_);
        merge_cells(levels, 0, most_cells, blocks);
        blocks.n_border_cells = n_border_cells;
        blocks.is_consistently_wound = false;
        blocks.borders.release();
        blocks.borders = {context_, "border lines"};
    }
    for (Level& level : levels) {
        level.cells.release();
        level.attributes.release();
        level.weights.release();
    }
    merge_triples(levels, blocks);
    return blocks;
}

}  // namespace hewer::cluster
