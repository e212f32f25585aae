// SPDX-License-Identifier: MIT
#include "streaming/ply_face_decoder.h"

#include <algorithm>

namespace hewer::streaming {

namespace {

/// As a 64-bit id; negative ids become huge.
template <typename T, bool Swap>
std::uint64_t load_id(const unsigned char* p) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(load<T, Swap>(p)));
}

/// n triangles whose first ids are `stride` bytes apart. Returns the largest id.
template <typename T, bool Swap>
std::uint64_t decode_triangles(const unsigned char* p, std::size_t stride, std::uint64_t n,
                               Triangle* out) {
    std::uint64_t largest = 0;
    for (std::uint64_t i = 0; i < n; ++i, p += stride) {
        const std::uint64_t a = load_id<T, Swap>(p);
        const std::uint64_t b = load_id<T, Swap>(p + sizeof(T));
        const std::uint64_t c = load_id<T, Swap>(p + 2 * sizeof(T));
        out[i] = {a, b, c};
        largest = std::max(largest, std::max(a, std::max(b, c)));
    }
    return largest;
}

template <typename T, bool Swap>
FaceFindings decode(const RowShape& shape, std::size_t list, std::uint64_t n_vertices,
                    const RowBlock& block, TriangleBatch& batch) {
    batch.corners.resize(block.n_triangles);
    const unsigned char* p = block.bytes.data();
    std::size_t available = block.n_bytes;

    if (block.stride != 0 && block.n_triangles == block.n_rows) {
        const unsigned char* ids = p;
        (void)walk_row(shape, Swap, p, available,
                       [&](std::size_t i, const unsigned char* items, std::uint64_t) {
                           if (i == list) ids = items;
                       });
        const std::uint64_t largest =
            decode_triangles<T, Swap>(ids, block.stride, block.n_rows, batch.corners.data());
        if (largest < n_vertices) return {};
    }

    FanWriter fans(batch.corners.data(), n_vertices);
    for (std::uint64_t row = 0; row < block.n_rows; ++row) {
        const std::size_t row_bytes =
            walk_row(shape, Swap, p, available,
                     [&](std::size_t i, const unsigned char* items, std::uint64_t count) {
                         if (i != list) return;
                         fans.add(row, count, [&] {
                             const std::uint64_t id = load_id<T, Swap>(items);
                             items += sizeof(T);
                             return id;
                         });
                     });
        p += row_bytes;
        available -= row_bytes;
    }
    batch.corners.resize(static_cast<std::size_t>(fans.end() - batch.corners.data()));
    return fans.findings();
}

}  // namespace

FaceFindings decode_faces(const RowShape& shape, bool swap, std::size_t list, ScalarType id_type,
                          std::uint64_t n_vertices, const RowBlock& block, TriangleBatch& batch) {
    return with_integer_type(id_type, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        return swap ? decode<T, true>(shape, list, n_vertices, block, batch)
                    : decode<T, false>(shape, list, n_vertices, block, batch);
    });
}

}  // namespace hewer::streaming
