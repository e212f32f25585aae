// SPDX-License-Identifier: MIT
#include "rsimp/cluster_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace hewer::rsimp {

using cluster::CellRecord;
using cluster::CellTriple;

namespace {

// Components are looked for in clusters of at most this many cells: larger ones will be split
// anyway, and the work per cell stays bounded.
constexpr std::uint32_t kMostCellsForComponents = 128;

}  // namespace

ClusterTree::ClusterTree(CellBlock block, Priority priority)
    : block_(std::move(block)), priority_(priority), place_of_id_(block_.cells.size()) {
    std::iota(place_of_id_.begin(), place_of_id_.end(), 0U);
    ClusterNode root;
    root.cell_end = static_cast<std::uint32_t>(block_.cells.size());
    root.face_end = static_cast<std::uint32_t>(block_.faces.size());
    add_node(root, std::numeric_limits<double>::infinity());
}

ClusterSums ClusterTree::sum(const ClusterNode& node) const {
    ClusterSums sums;
    for (std::uint32_t i = node.cell_begin; i < node.cell_end; ++i) {
        const CellRecord& cell = block_.cells[i];
        sums.add(cell);
        if (priority_ == Priority::NormalVariation) {
            const auto& n = block_.attributes[cell.id].face_normal;
            for (std::size_t k = 0; k < 3; ++k) sums.face_normal[k] += static_cast<double>(n[k]);
        }
    }
    return sums;
}

void ClusterTree::add_node(const ClusterNode& subranges, double parent_key) {
    ClusterNode node = subranges;
    const std::uint32_t n = node.cell_end - node.cell_begin;
    if (n == 1) {
        nodes_.push_back(node);  // key 0: cannot be split
        return;
    }
    if (n <= kMostCellsForComponents && label_components(node) > 1) {
        node.is_disconnected = true;
        node.key = parent_key;
        nodes_.push_back(node);
        return;
    }
    const ClusterSums sums = sum(node);
    const cluster::Eigen3 eigen = cluster::eigen_decomposition(sums.quadric.a);
    node.key = std::min(parent_key, priority(sums, representative(sums, eigen), priority_));
    node.plane = split_plane(sums, eigen);
    nodes_.push_back(node);
}

void ClusterTree::grow(double threshold) {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].first_child == 0 && nodes_[i].key > threshold) open.push_back(i);
    }
    while (!open.empty()) {
        const std::uint32_t index = open.back();
        open.pop_back();
        split(index);
        for (std::uint32_t c = nodes_[index].first_child; c < nodes_[index].first_child + 2; ++c) {
            if (nodes_[c].key > threshold) open.push_back(c);
        }
    }
}

void ClusterTree::split(std::uint32_t index) {
    const ClusterNode node = nodes_[index];
    const std::uint32_t middle =
        node.is_disconnected ? partition_by_components(node) : partition_by_plane(node);

    // Faces: separated ones first, then those with two corners in the first child, then in the
    // second. A face with its third corner outside, or in the other child, belongs where its other
    // two are.
    std::vector<CellTriple>& faces = block_.faces;
    const auto side = [&](std::uint32_t id) -> int {
        if (id == CellBlock::kOutside) return 0;
        const std::uint32_t at = place_of_id_[id];
        if (at < node.cell_begin || at >= node.cell_end) return 0;
        return at < middle ? 1 : 2;
    };
    const auto child_of = [&](const CellTriple& face) -> int {
        std::array<int, 3> count{};
        for (const std::uint32_t id : face) ++count[static_cast<std::size_t>(side(id))];
        return count[1] >= 2 ? 1 : (count[2] >= 2 ? 2 : 0);
    };
    std::uint32_t low = node.face_begin;  // [face_begin, low): separated
    std::uint32_t mid = node.face_begin;  // [low, mid): first child
    std::uint32_t high = node.face_end;   // [high, face_end): second child
    while (mid < high) {
        switch (child_of(faces[mid])) {
            case 0:
                std::swap(faces[low++], faces[mid++]);
                break;
            case 1:
                ++mid;
                break;
            default:
                std::swap(faces[mid], faces[--high]);
                break;
        }
    }

    nodes_[index].first_child = static_cast<std::uint32_t>(nodes_.size());
    ClusterNode child;
    child.cell_begin = node.cell_begin;
    child.cell_end = middle;
    child.face_begin = low;
    child.face_end = mid;
    add_node(child, node.key);
    child.cell_begin = middle;
    child.cell_end = node.cell_end;
    child.face_begin = mid;
    child.face_end = node.face_end;
    add_node(child, node.key);
}

void ClusterTree::swap_cells(std::uint32_t i, std::uint32_t j) {
    std::vector<CellRecord>& cells = block_.cells;
    std::swap(cells[i], cells[j]);
    place_of_id_[cells[i].id] = i;
    place_of_id_[cells[j].id] = j;
}

std::uint32_t ClusterTree::partition_by_plane(const ClusterNode& node) {
    const std::vector<CellRecord>& cells = block_.cells;
    const Vec3& d = node.plane.direction;
    const auto is_second = [&](const CellRecord& cell) {
        const Vec3 p{static_cast<double>(cell.mean[0]), static_cast<double>(cell.mean[1]),
                     static_cast<double>(cell.mean[2])};
        return dot(d, p) > node.plane.offset;
    };
    std::uint32_t i = node.cell_begin;
    std::uint32_t j = node.cell_end;
    while (i < j) {
        if (!is_second(cells[i])) {
            ++i;
        } else {
            swap_cells(i, --j);
        }
    }
    // All on one side: equal positions, to rounding. Any halving will do.
    if (i == node.cell_begin || i == node.cell_end) {
        i = node.cell_begin + (node.cell_end - node.cell_begin) / 2;
    }
    return i;
}

std::uint32_t ClusterTree::label_components(const ClusterNode& node) {
    const std::uint32_t n = node.cell_end - node.cell_begin;
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
    const std::uint32_t base = node.cell_begin;
    // Cells without a face are no components of the surface; they go with the first cell.
    const CellRecord* cells = &block_.cells[base];
    for (std::uint32_t i = 1; i < n; ++i) {
        if ((cells[i].flags & CellRecord::kHasFace) == 0) unite(0, i);
    }
    for (std::uint32_t f = node.face_begin; f < node.face_end && n_components > 1; ++f) {
        std::array<std::uint32_t, 3> inside;
        std::size_t count = 0;
        for (const std::uint32_t id : block_.faces[f]) {
            if (id == CellBlock::kOutside) continue;
            const std::uint32_t at = place_of_id_[id];
            if (at >= base && at < base + n) inside[count++] = at - base;
        }
        for (std::size_t k = 1; k < count; ++k) unite(inside[0], inside[k]);
    }
    return n_components;
}

std::uint32_t ClusterTree::partition_by_components(const ClusterNode& node) {
    const std::uint32_t n = node.cell_end - node.cell_begin;
    label_components(node);
    for (std::uint32_t i = 0; i < n; ++i) labels_[i] = labels_[labels_[i]];
    for (std::uint32_t i = 0; i < n; ++i) {
        while (labels_[labels_[i]] != labels_[i]) labels_[i] = labels_[labels_[i]];
    }
    // Components in the order of their lowest cell id, which no partition changes; the first half
    // of them becomes the first child.
    const CellRecord* cells = &block_.cells[node.cell_begin];
    std::vector<std::uint32_t> lowest(n, std::numeric_limits<std::uint32_t>::max());
    for (std::uint32_t i = 0; i < n; ++i) {
        lowest[labels_[i]] = std::min(lowest[labels_[i]], cells[i].id);
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
            swap_cells(node.cell_begin + i, node.cell_begin + j);
            std::swap(is_second[i], is_second[j]);
        }
    }
    return node.cell_begin + i;
}

}  // namespace hewer::rsimp
