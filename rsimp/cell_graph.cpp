// SPDX-License-Identifier: MIT
#include "rsimp/cell_graph.h"

#include <algorithm>
#include <utility>

namespace hewer::rsimp {

void CellGraph::add_edges_of(const cluster::CellTriple& face, std::uint64_t first_cell,
                             std::uint64_t last_cell) {
    std::array<LocalCell, 3> inside;
    std::size_t n = 0;
    for (const std::uint32_t id : face) {
        if (id < first_cell || id >= last_cell) continue;
        const auto cell = static_cast<LocalCell>(id - first_cell);
        has_face_[cell] = 1;
        inside[n++] = cell;
    }
    const auto add = [&](LocalCell a, LocalCell b) {
        edges_.push_back({std::min(a, b), std::max(a, b)});
        ++end_[edges_.back().from];
    };
    if (n < 3) {
        for (std::size_t i = 0; i < n; ++i) leaves_block_[inside[i]] = 1;
    }
    if (n < 2) return;
    add(inside[0], inside[1]);
    if (n < 3) return;
    add(inside[1], inside[2]);
    add(inside[0], inside[2]);
}

void CellGraph::load(const cluster::CellBlocks& blocks, std::size_t block) {
    const auto& first = blocks.blocks[block];
    const auto& last = blocks.blocks[block + 1];
    const std::uint64_t n = last.first_cell - first.first_cell;
    edges_.clear();
    has_face_.assign(n, 0);
    leaves_block_.assign(n, 0);
    degree_.assign(n, 0);
    end_.assign(n, 0);
    ooc::SpoolReader<cluster::CellTriple> faces(blocks.faces, first.first_face, last.first_face);
    for (auto piece = faces.next_piece(); !piece.empty(); piece = faces.next_piece()) {
        for (const auto& face : piece) add_edges_of(face, first.first_cell, last.first_cell);
    }
    // From counts to places; each list then loses its copies.
    begin_.resize(n);
    std::uint32_t sum = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
        begin_[i] = sum;
        sum += std::exchange(end_[i], sum);
    }
    neighbours_.resize(sum);
    for (const Edge& edge : edges_) neighbours_[end_[edge.from]++] = edge.to;
    for (std::uint64_t i = 0; i < n; ++i) {
        const auto from = neighbours_.begin() + begin_[i];
        const auto to = neighbours_.begin() + end_[i];
        std::sort(from, to);
        const auto end = std::unique(from, to);
        end_[i] = begin_[i] + static_cast<std::uint32_t>(end - from);
        degree_[i] = static_cast<LocalCell>(degree_[i] + (end - from));
        for (auto j = from; j != end; ++j) ++degree_[*j];
    }
}

}  // namespace hewer::rsimp
