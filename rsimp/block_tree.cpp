// SPDX-License-Identifier: MIT
#include "rsimp/block_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace hewer::rsimp {

using cluster::CellRecord;

namespace {

// Components are looked for in clusters of at most this many cells: larger ones will be split
// anyway, and the work per cell stays bounded. 1024 and 128 give the same error within a per cent.
constexpr std::uint32_t kMostCellsForComponents = 256;
// From a part of the surface to the four clusters of its simplest closed form.
constexpr std::uint8_t kSplitsOfPart = 3;
// Where those were not enough, as their faces may cancel; the collapse takes what is too much.
constexpr std::uint8_t kSplitsOfVanished = 5;
constexpr double kNoSplit = -1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 mean_of(const CellRecord& cell) {
    return {static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
            static_cast<double>(cell.mean[2])};
}

}  // namespace

void BlockTree::load(const cluster::CellBlocks& blocks, std::size_t block, Priority priority,
                     const BlockCut& cut) {
    const std::uint64_t first = blocks.blocks[block].first_cell;
    const std::uint64_t last = blocks.blocks[block + 1].first_cell;
    const std::uint64_t n = last - first;
    priority_ = priority;
    graph_.load(blocks, block);

    position_.resize(n);
    if (cut.order.empty()) {
        std::iota(position_.begin(), position_.end(), LocalCell{0});
    } else {
        for (std::uint64_t i = 0; i < n; ++i) position_[cut.order[i]] = static_cast<LocalCell>(i);
    }
    cells_.resize(n);
    const Vec3 origin = cluster::center_of(blocks.codes.at(first + n / 2));
    ooc::SpoolReader<CellRecord> cells(blocks.cells, first, last);
    ooc::SpoolReader<std::uint64_t> codes(blocks.codes, first, last);
    for (std::uint64_t i = 0; i < n; ++i) {
        CellRecord& cell = cells_[position_[i]];
        cell = *cells.next();
        cell.id = static_cast<std::uint32_t>(i);
        const Vec3 shift = cluster::center_of(*codes.next()) - origin;
        for (std::size_t k = 0; k < 3; ++k) {
            cell.mean[k] = static_cast<float>(shift[k] + static_cast<double>(cell.mean[k]));
        }
    }
    face_normals_.clear();
    if (priority == Priority::NormalVariation) {
        ooc::SpoolReader<cluster::CellAttributes> attributes(blocks.attributes, first, last);
        while (const auto* a = attributes.next()) face_normals_.push_back(a->face_normal);
    }
    attributes_.resize(blocks.attribute_quadrics.empty() ? 0 : n);
    if (!attributes_.empty()) blocks.attribute_quadrics.read(first, std::span(attributes_));
    vanished_.resize(blocks.vanished.empty() ? 0 : n);
    if (!vanished_.empty()) blocks.vanished.read(first, std::span(vanished_));
    split_keys_.assign(n, kNoSplit);
    for (std::size_t i = 0; i < cut.begins.size(); ++i) split_keys_[cut.begins[i]] = cut.keys[i];
}

void BlockTree::store(BlockCut& cut) const {
    cut.order.resize(cells_.size());
    cut.begins.clear();
    cut.keys.clear();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        cut.order[i] = static_cast<LocalCell>(cells_[i].id);
        if (split_keys_[i] < 0) continue;
        cut.begins.push_back(static_cast<LocalCell>(i));
        cut.keys.push_back(split_keys_[i]);
    }
}

template <typename Visit>
void BlockTree::for_each_root(const BlockCut& cut, const Visit& visit) {
    const auto n = static_cast<std::uint32_t>(cells_.size());
    // The parent of a cluster parts it from one neighbour, an ancestor with no smaller key from the
    // other.
    double left_key = kInfinity;
    std::uint32_t begin = 0;
    for (std::size_t i = 0; i <= cut.begins.size(); ++i) {
        const bool is_last = i == cut.begins.size();
        const std::uint32_t end = is_last ? n : cut.begins[i];
        const double right_key = is_last ? kInfinity : cut.keys[i];
        visit(make_node(begin, end, std::min(left_key, right_key), 0));
        left_key = right_key;
        begin = end;
    }
}

void BlockTree::grow_to_key(const cluster::CellBlocks& blocks, std::size_t block, Priority priority,
                            double threshold, BlockCut& cut) {
    load(blocks, block, priority, cut);
    for_each_root(cut, [&](const Node& root) {
        if (root.key > threshold) open_.push_back(root);
        while (!open_.empty()) {
            const Node node = open_.back();
            open_.pop_back();
            const auto children = split(node);
            // The smaller one goes first: no more than log2(cells) nodes are ever open.
            const bool is_first_smaller =
                children[0].end - children[0].begin < children[1].end - children[1].begin;
            for (const Node& child : {children[is_first_smaller], children[!is_first_smaller]}) {
                if (child.key > threshold) open_.push_back(child);
            }
        }
    });
    store(cut);
    cut.threshold = threshold;
}

void BlockTree::grow_by_splits(const cluster::CellBlocks& blocks, std::size_t block,
                               Priority priority, std::uint64_t n_splits, BlockCut& cut) {
    const auto is_smaller = [](const Node& a, const Node& b) { return a.key < b.key; };
    const auto push = [&](const Node& node) {
        if (node.key <= 0) return;
        open_.push_back(node);
        std::push_heap(open_.begin(), open_.end(), is_smaller);
    };
    load(blocks, block, priority, cut);
    for_each_root(cut, push);
    double last_key = kInfinity;
    // Equal keys go together, so that a cut never parts a cluster from what is due below it.
    for (; !open_.empty() && (n_splits > 0 || open_.front().key == last_key);
         n_splits -= n_splits > 0 ? 1 : 0) {
        std::pop_heap(open_.begin(), open_.end(), is_smaller);
        const Node node = open_.back();
        open_.pop_back();
        last_key = node.key;
        for (const Node& child : split(node)) push(child);
    }
    store(cut);
    cut.threshold = open_.empty() ? 0 : open_.front().key;
    open_.clear();
}

BlockTree::Node BlockTree::make_node(std::uint32_t begin, std::uint32_t end, double parent_key,
                                     std::uint8_t n_due) {
    Node node;
    node.begin = begin;
    node.end = end;
    const std::uint32_t n = end - begin;
    if (n == 1) return node;
    if (n <= kMostCellsForComponents && label_components(begin, end) > 1) {
        node.is_disconnected = true;
        node.n_due = n_due;
        node.key = parent_key;
        return node;
    }
    const double loss = cost_of_loss(begin, end);
    const bool is_whole = is_closed_off(begin, end, loss > 0);
    node.n_due = !is_whole ? n_due : loss > 0 ? kSplitsOfVanished : kSplitsOfPart;
    ClusterSums sums;
    for (std::uint32_t i = begin; i < end; ++i) sums.add(cells_[i]);
    if (!face_normals_.empty()) {
        for (std::uint32_t i = begin; i < end; ++i) {
            const auto& normal = face_normals_[cells_[i].id];
            for (std::size_t k = 0; k < 3; ++k) {
                sums.face_normal[k] += static_cast<double>(normal[k]);
            }
        }
    }
    if (!attributes_.empty()) {
        cluster::AttributeQuadric attributes;
        for (std::uint32_t i = begin; i < end; ++i) {
            attributes += attributes_[cells_[i].id].at(mean_of(cells_[i]));
        }
        sums.quadric += attributes.reduced();
    }
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    if (n_due > 0) {
        node.key = parent_key;
    } else {
        const double key = rsimp::priority(sums, representative(sums, eigen), priority_);
        const double least = is_whole ? std::max(part_priority(sums, priority_), loss) : 0;
        node.key = std::min(parent_key, std::max(key, least));
    }
    node.plane = split_plane(sums, eigen);
    return node;
}

std::array<BlockTree::Node, 2> BlockTree::split(const Node& node) {
    const std::uint32_t middle =
        node.is_disconnected ? partition_by_components(node) : partition_by_plane(node);
    split_keys_[middle] = node.key;
    // Half of the splits that are left to each child, as far as it has the cells for them.
    const std::uint32_t n_left = node.n_due - (node.n_due > 0 ? 1U : 0U);
    const std::uint32_t n_second =
        std::min(n_left - std::min(n_left / 2, middle - node.begin - 1), node.end - middle - 1);
    const std::uint32_t n_first = std::min(n_left - n_second, middle - node.begin - 1);
    return {make_node(node.begin, middle, node.key, static_cast<std::uint8_t>(n_first)),
            make_node(middle, node.end, node.key, static_cast<std::uint8_t>(n_second))};
}

void BlockTree::swap_cells(std::uint32_t i, std::uint32_t j) {
    std::swap(cells_[i], cells_[j]);
    position_[cells_[i].id] = static_cast<LocalCell>(i);
    position_[cells_[j].id] = static_cast<LocalCell>(j);
}

std::uint32_t BlockTree::partition_by_plane(const Node& node) {
    const Vec3& d = node.plane.direction;
    const auto is_second = [&](const CellRecord& cell) {
        return dot(d, mean_of(cell)) > node.plane.offset;
    };
    std::uint32_t i = node.begin;
    std::uint32_t j = node.end;
    while (i < j) {
        if (!is_second(cells_[i])) {
            ++i;
        } else {
            swap_cells(i, --j);
        }
    }
    // All on one side: equal positions, to rounding. Any halving will do.
    if (i == node.begin || i == node.end) i = node.begin + (node.end - node.begin) / 2;
    return i;
}

std::uint32_t BlockTree::label_components(std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t n = end - begin;
    labels_.resize(n);
    std::iota(labels_.begin(), labels_.end(), 0U);
    const auto find = [&](std::uint32_t i) {
        while (labels_[i] != i) i = labels_[i] = labels_[labels_[i]];
        return i;
    };
    std::uint32_t n_components = n;
    const auto unite = [&](std::uint32_t i, std::uint32_t j) {
        i = find(i);
        j = find(j);
        if (i == j) return;
        labels_[std::max(i, j)] = std::min(i, j);
        --n_components;
    };
    for (std::uint32_t i = 0; i < n && n_components > 1; ++i) {
        const auto cell = static_cast<LocalCell>(cells_[begin + i].id);
        // Cells without a face are no components of the surface; they go with the first cell.
        if (!graph_.has_face(cell)) unite(0, i);
        for (const LocalCell neighbour : graph_.later_neighbours(cell)) {
            const std::uint32_t at = position_[neighbour];
            if (at >= begin && at < end) unite(i, at - begin);
        }
    }
    return n_components;
}

/// Whether the cells hang together with no others, or, `across` the walls of the block, with none
/// in the block.
bool BlockTree::is_closed_off(std::uint32_t begin, std::uint32_t end, bool across) const {
    std::uint64_t n_ends = 0;
    std::uint64_t n_inside = 0;
    for (std::uint32_t i = begin; i < end; ++i) {
        const auto cell = static_cast<LocalCell>(cells_[i].id);
        if (!across && graph_.leaves_block(cell)) return false;
        n_ends += graph_.degree(cell);
        for (const LocalCell neighbour : graph_.later_neighbours(cell)) {
            const std::uint32_t at = position_[neighbour];
            if (at < begin || at >= end) return false;
            ++n_inside;
        }
    }
    return n_ends > 0 && n_ends == 2 * n_inside;
}

/// What it cost that cells had vanished from a level of detail before, in squared distance.
double BlockTree::cost_of_loss(std::uint32_t begin, std::uint32_t end) const {
    double cost = 0;
    if (vanished_.empty() || priority_ != Priority::Quadric) return cost;
    for (std::uint32_t i = begin; i < end; ++i) {
        cost += static_cast<double>(cells_[i].area) * static_cast<double>(vanished_[cells_[i].id]);
    }
    return cost;
}

std::uint32_t BlockTree::partition_by_components(const Node& node) {
    const std::uint32_t n = node.end - node.begin;
    label_components(node.begin, node.end);
    // A label is never larger than its place: one pass finds all roots.
    for (std::uint32_t i = 0; i < n; ++i) labels_[i] = labels_[labels_[i]];
    // Components in the order of their first cell in the block, which no partition changes; the
    // first half of them becomes the first child.
    std::vector<std::uint32_t> lowest(n, std::numeric_limits<std::uint32_t>::max());
    for (std::uint32_t i = 0; i < n; ++i) {
        lowest[labels_[i]] = std::min(lowest[labels_[i]], cells_[node.begin + i].id);
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < n; ++i) {
        if (labels_[i] == i) order.push_back(lowest[i]);
    }
    std::sort(order.begin(), order.end());
    const std::uint32_t bound = order[order.size() / 2];
    std::vector<char> is_second(n);
    for (std::uint32_t i = 0; i < n; ++i) is_second[i] = lowest[labels_[i]] >= bound ? 1 : 0;
    std::uint32_t i = 0;
    std::uint32_t j = n;
    while (i < j) {
        if (is_second[i] == 0) {
            ++i;
        } else {
            --j;
            swap_cells(node.begin + i, node.begin + j);
            std::swap(is_second[i], is_second[j]);
        }
    }
    return node.begin + i;
}

}  // namespace hewer::rsimp
