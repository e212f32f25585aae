// SPDX-License-Identifier: MIT
#include "cluster/triangle_partition.h"

#include <algorithm>

#include "cluster/vertex_store.h"

namespace hewer::cluster {

namespace {
// Handed to a worker at once.
constexpr std::uint64_t kAtOnce = 4096;
}  // namespace

TrianglePartition::TrianglePartition(ooc::Context& context) {
    for (auto& box : boxes_) box = {context, "triangles by place"};
}

void TrianglePartition::flush(std::size_t box) {
    boxes_[box].append(waiting_[box]);
    waiting_[box].clear();
}

void TrianglePartition::finish() {
    for (std::uint32_t b = 0; b < kBoxes; ++b) {
        flush(b);
        waiting_[b] = std::vector<LatticeTriangle>();
        std::uint32_t n_pieces = 0;
        for (std::uint64_t first = 0; first < boxes_[b].size(); first += kAtOnce, ++n_pieces) {
            const auto n = static_cast<std::uint32_t>(std::min(kAtOnce, boxes_[b].size() - first));
            pieces_.push_back({b, n, first});
        }
        n_unread_[b] = n_pieces;
    }
}

bool TrianglePartition::next(std::vector<LatticeTriangle>& triangles) {
    const std::size_t p = next_.fetch_add(1);
    if (p >= pieces_.size()) return false;
    const Piece& piece = pieces_[p];
    triangles.resize(piece.n);
    boxes_[piece.box].read(piece.first, triangles);
    // Pieces are taken in order but may be read in any: the last reader of a box, whoever it is,
    // gives its space back.
    if (n_unread_[piece.box].fetch_sub(1) == 1) {
        boxes_[piece.box].discard_before(boxes_[piece.box].size());
    }
    return true;
}

PartitionFindings partition_soup(ooc::Context& context, MeshSource& source, const Lattice& lattice,
                                 const Bounds& bounds, TrianglePartition& partition) {
    PartitionFindings findings;
    source.begin_triangles();
    TriangleBatch batch;
    while (source.next_triangles(batch)) {
        for (const auto& points : batch.points) {
            LatticeTriangle t;
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t k = 0; k < 3; ++k) {
                    if (!(points[c][k] >= bounds.min[k] && points[c][k] <= bounds.max[k])) {
                        throw_outside_bounds(source, "a triangle");
                    }
                }
                t[c] = lattice.encode(points[c]);
            }
            partition.add(t);
        }
        findings.defects.merge(batch.defects);
        context.advance(batch.n_faces);
    }
    partition.finish();
    return findings;
}

}  // namespace hewer::cluster
