// SPDX-License-Identifier: MIT
/// Raw vertex rows to positions, normals, colours and weights.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hewer/mesh_source.h"
#include "streaming/ply_layout.h"

namespace hewer::streaming {

/// Rows without lists, `stride` bytes each, in this machine's byte order or (`swap`) the other.
struct PackedRows {
    const unsigned char* data = nullptr;
    std::size_t stride = 0;
    std::size_t n = 0;
    bool swap = false;
};

/// Fills positions, normals, colors and weights of `batch` (storage reused, nothing zeroed first)
/// and counts the positions that are not finite in batch.defects.nonfinite_vertices. Works by
/// columns: one tight loop for each property, chosen once a block, no branch on types per element;
/// the block stays in the cache meanwhile. Thread-safe.
/// @returns the index of the first row with a non-finite position, or rows.n.
std::size_t decode_vertices(const PlyVertexFields& fields, const PackedRows& rows,
                            VertexBatch& batch);

}  // namespace hewer::streaming
