// SPDX-License-Identifier: MIT
/// The document of the glTF files that are written: one mesh of one primitive.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "hewer/mesh_sink.h"
#include "hewer/types.h"

namespace hewer::streaming {

/// A piece of the buffer.
struct GltfPiece {
    std::uint64_t offset = 0;
    std::uint64_t bytes = 0;
};

/// What the document says of the buffer. Plain: n_vertices records of vertex_bytes() each, then
/// 3 * n_triangles indices. Compressed by meshopt: these two, packed. By Draco: one piece.
struct GltfLayout {
    std::uint64_t n_vertices = 0;
    std::uint64_t n_triangles = 0;
    bool has_normals = false;
    bool has_colors = false;
    bool has_transparency = false;  ///< some alpha is below one: the material blends
    Vec3 min{};                     ///< exactly of the positions as stored
    Vec3 max{};
    Vec3 translation{0, 0, 0};  ///< of the node: added to the positions by every viewer
    double step = 0;            ///< scale of the node, of positions that are integers; 0: floats
    std::string uri;            ///< of the buffer; empty: the chunk of a GLB

    Compression compression = Compression::None;
    GltfPiece packed_vertices;      ///< Meshopt; Draco: all
    GltfPiece packed_indices;       ///< Meshopt
    std::uint32_t position_id = 0;  ///< Draco
    std::uint32_t normal_id = 0;
    std::uint32_t color_id = 0;

    [[nodiscard]] bool is_quantized() const { return step > 0; }
    /// POSITION 3 floats, or 3 ushorts and padding; NORMAL 3 floats, or 3 normalised bytes and
    /// padding; COLOR_0 4 normalised ushorts.
    [[nodiscard]] std::uint64_t normals_offset() const { return is_quantized() ? 8 : 12; }
    [[nodiscard]] std::uint64_t colors_offset() const {
        return normals_offset() + (!has_normals ? 0U : is_quantized() ? 4U : 12U);
    }
    [[nodiscard]] std::uint64_t vertex_bytes() const {
        return colors_offset() + (has_colors ? 8U : 0U);
    }
    /// 65535 itself is the restart value and must not be an index.
    [[nodiscard]] bool has_short_indices() const { return n_vertices <= 65535; }
    [[nodiscard]] std::uint64_t index_bytes() const { return has_short_indices() ? 2 : 4; }
    [[nodiscard]] std::uint64_t indices_offset() const { return n_vertices * vertex_bytes(); }
    /// Of the plain buffer.
    [[nodiscard]] std::uint64_t plain_bytes() const {
        return indices_offset() + 3 * n_triangles * index_bytes();
    }
    /// Of the buffer as it is stored, without padding at its end.
    [[nodiscard]] std::uint64_t binary_bytes() const {
        switch (compression) {
            case Compression::None:
                break;
            case Compression::Meshopt:
                return packed_indices.offset + packed_indices.bytes;
            case Compression::Draco:
                return packed_vertices.bytes;
        }
        return plain_bytes();
    }
};

/// glTF 2.0 JSON, valid by the Khronos validator without a warning. Without a uri and compression
/// at most kGltfTextBytes.
std::string gltf_text(const GltfLayout& layout);

/// The longest such document, with numbers of as many digits as they can have, has about 1,500.
constexpr std::uint64_t kGltfTextBytes = 2048;

}  // namespace hewer::streaming
