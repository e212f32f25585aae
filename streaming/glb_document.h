// SPDX-License-Identifier: MIT
/// The JSON half of a GLB file: one mesh of one primitive over one interleaved vertex buffer.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "hewer/types.h"

namespace hewer::streaming {

/// What the document says of the binary chunk: n_vertices records of vertex_bytes() each, then
/// 3 * n_triangles indices, then zeros up to a multiple of four.
struct GlbLayout {
    std::uint64_t n_vertices = 0;
    std::uint64_t n_triangles = 0;
    bool has_normals = false;
    bool has_colors = false;
    bool has_transparency = false;  ///< some alpha is below one: the material blends
    std::array<float, 3> min{};     ///< exactly of the positions as stored
    std::array<float, 3> max{};
    Vec3 translation{0, 0, 0};  ///< of the node: added to the positions by every viewer

    /// POSITION 3 floats, NORMAL 3 floats, COLOR_0 4 normalised ushorts.
    [[nodiscard]] std::uint64_t vertex_bytes() const {
        return 12U + (has_normals ? 12U : 0U) + (has_colors ? 8U : 0U);
    }
    /// 65535 itself is the restart value and must not be an index.
    [[nodiscard]] bool has_short_indices() const { return n_vertices <= 65535; }
    [[nodiscard]] std::uint64_t indices_offset() const { return n_vertices * vertex_bytes(); }
    /// Of the chunk without its padding.
    [[nodiscard]] std::uint64_t binary_bytes() const {
        return indices_offset() + n_triangles * (has_short_indices() ? 6U : 12U);
    }
};

/// glTF 2.0 JSON, valid by the Khronos validator without a warning. At most kGlbDocumentBytes.
std::string glb_document(const GlbLayout& layout);

/// The longest document, with numbers of as many digits as they can have, has about 1,200.
constexpr std::uint64_t kGlbDocumentBytes = 2048;

}  // namespace hewer::streaming
