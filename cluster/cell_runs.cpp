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
    ooc::radix_sort(triples, scratch, [](const CellTriple& t) { return median_corner(t); });
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

void add_to(CellSums& sums, const RunCell& part) {
    for (std::size_t i = 0; i < sums.surface.size(); ++i) sums.surface[i] += part.surface[i];
    for (std::size_t i = 0; i < sums.border.size(); ++i) sums.border[i] += part.border[i];
    sums.is_touched |= part.is_touched;
}

void add_to(AttributeSums& sums, const AttributeSums& part) {
    for (std::size_t i = 0; i < 3; ++i) {
        sums.normal[i] += part.normal[i];
        sums.face_normal[i] += part.face_normal[i];
    }
    for (std::size_t i = 0; i < 4; ++i) sums.color[i] += part.color[i];
    sums.n_colors += part.n_colors;
}

}  // namespace

void CellRuns::clear() {
    cells_ = {context_, "cell sums"};
    attributes_ = {};
    if (has_attributes_) attributes_ = {context_, "attribute sums"};
    triples_ = {context_, "surviving triangles"};
    ends_ = {{0, 0}};
}

std::uint64_t CellRuns::buffer_bytes() const {
    return std::clamp<std::uint64_t>(context_.budget().limit() / kBufferShare / n_runs(),
                                     kLeastBufferBytes, ooc::SpoolReader<RunCell>::kBufferBytes);
}

void CellRuns::add(CellTable& table, std::vector<TripleList>& triples) {
    const std::uint64_t n = table.size();
    ooc::Array<CodedSlot> order(context_.budget(), "cell order", n);
    std::uint64_t i = 0;
    table.for_each([&](CellKey key, std::uint32_t slot) { order[i++] = {morton(key), slot, 0}; });
    {
        ooc::Array<CodedSlot> scratch(context_.budget(), "cell order", n);
        ooc::radix_sort(order, scratch, [](const CodedSlot& s) { return s.code; });
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
            triples_.append(piece);
        }
    }
    std::vector<RunCell> cells;
    std::vector<AttributeSums> attributes;
    for (std::uint64_t first = 0; first < n; first += kPiece) {
        cells.clear();
        attributes.clear();
        for (std::uint64_t k = first; k < std::min(n, first + kPiece); ++k) {
            const std::uint32_t slot = order[k].slot;
            cells.push_back(run_cell(order[k].code, table.sums(slot)));
            if (has_attributes_) attributes.push_back(table.attributes(slot));
        }
        cells_.append(cells);
        if (has_attributes_) attributes_.append(attributes);
        context_.check_stop();
    }
    ends_.push_back({cells_.size(), triples_.size()});
}

void CellRuns::merge_cells(double border_weight, std::uint64_t most_cells,
                           CellBlocks& blocks) const {
    const FixedPoint fixed(blocks.grid.resolution());
    std::vector<ooc::SpoolReader<RunCell>> readers;
    std::vector<ooc::SpoolReader<AttributeSums>> attribute_readers;
    const ooc::Reservation buffers = context_.budget().reserve(
        "merging cells", n_runs() * buffer_bytes() * (has_attributes_ ? 2 : 1));
    for (std::size_t r = 0; r < n_runs(); ++r) {
        const std::uint64_t first = ends_[r].cell;
        const std::uint64_t last = ends_[r + 1].cell;
        readers.emplace_back(cells_, first, last, buffer_bytes());
        if (has_attributes_)
            attribute_readers.emplace_back(attributes_, first, last, buffer_bytes());
    }
    const auto code_of = [](const RunCell& cell) { return cell.code; };
    RunMerger<RunCell, decltype(code_of)> merger(readers, code_of);
    BlockCutter cutter(blocks, most_cells);
    std::vector<std::uint64_t> codes;
    std::vector<CellRecord> cells;
    std::vector<CellAttributes> attributes;
    const auto flush = [&] {
        cutter.add(codes);
        blocks.cells.append(cells);
        if (has_attributes_) blocks.attributes.append(attributes);
        codes.clear();
        cells.clear();
        attributes.clear();
        context_.check_stop();
    };
    while (!merger.empty()) {
        const std::uint64_t code = merger.key();
        CellSums sums{};
        AttributeSums attribute_sums{};
        while (!merger.empty() && merger.key() == code) {
            if (has_attributes_) add_to(attribute_sums, *attribute_readers[merger.run()].next());
            add_to(sums, merger.take());
        }
        if (sums.is_touched == 0) continue;
        if (has_border(sums)) ++blocks.n_border_cells;
        codes.push_back(code);
        cells.push_back(make_record(sums, fixed, border_weight));
        if (has_attributes_) attributes.push_back(make_attributes(attribute_sums, fixed));
        if (codes.size() == kPiece) flush();
    }
    flush();
    cutter.finish();
}

void CellRuns::merge_triples(CellBlocks& blocks) {
    const ooc::Reservation buffers =
        context_.budget().reserve("merging triangles", n_runs() * buffer_bytes());
    std::vector<ooc::SpoolReader<CodeTriple>> readers;
    for (std::size_t r = 0; r < n_runs(); ++r) {
        readers.emplace_back(triples_, ends_[r].triple, ends_[r + 1].triple, buffer_bytes());
    }
    const auto median = [](const CodeTriple& t) { return median_corner(t); };
    RunMerger<CodeTriple, decltype(median)> merger(readers, median);
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
    CellBlocks blocks = make_cell_blocks(context_, lattice, grid, has_attributes_);
    merge_cells(border_weight, most_cells, blocks);
    if (is_border_implausible(blocks.n_border_cells, blocks.n_cells())) {
        const std::uint64_t n_border_cells = blocks.n_border_cells;
        blocks = make_cell_blocks(context_, lattice, grid, has_attributes_);
        merge_cells(0, most_cells, blocks);
        blocks.n_border_cells = n_border_cells;
        blocks.is_consistently_wound = false;
    }
    cells_.release();
    attributes_.release();
    merge_triples(blocks);
    clear();
    return blocks;
}

}  // namespace hewer::cluster
