// SPDX-License-Identifier: MIT
/// Raw face rows to triangles.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hewer/mesh_source.h"
#include "streaming/row_reader.h"
#include "streaming/triangle_fan.h"

namespace hewer::streaming {

/// Replaces batch.corners by the fans of the block's faces (storage reused, nothing zeroed first).
/// Ids that are no vertex are looked for by one maximum over a block of triangles; only when it is
/// too large, the block is decoded again, face by face. Thread-safe.
/// @param list, id_type  the list of vertex ids in a row, and its type: an integer type.
FaceFindings decode_faces(const RowShape& shape, bool swap, std::size_t list, ScalarType id_type,
                          std::uint64_t n_vertices, const RowBlock& block, TriangleBatch& batch);

}  // namespace hewer::streaming
