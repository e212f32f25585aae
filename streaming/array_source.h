// SPDX-License-Identifier: MIT
/// A mesh whose vertices and indices lie in a file as arrays of numbers at equal distances.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hewer/mesh_source.h"
#include "ooc/file.h"
#include "streaming/scalar_type.h"

namespace hewer::streaming {

/// `count` elements of `n_components` little-endian numbers, `stride` bytes from one to the next.
/// No file: `count` zeros. Precondition: all of it lies within the file.
struct StridedArray {
    std::shared_ptr<const ooc::InputFile> file;
    std::uint64_t offset = 0;
    std::uint64_t stride = 0;
    std::uint64_t count = 0;  ///< 0: there is no such array
    unsigned n_components = 0;
    ScalarType type = ScalarType::Float32;
    bool is_normalized = false;  ///< integers mean 0..1, or -1..1

    [[nodiscard]] std::uint64_t element_bytes() const {
        return n_components * std::uint64_t{byte_size(type)};
    }
};

/// Rows of an affine map.
using Affine = std::array<std::array<double, 4>, 3>;
constexpr Affine kIdentity{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

inline Vec3 transformed(const Affine& m, const Vec3& p) {
    Vec3 q{};
    for (std::size_t i = 0; i < 3; ++i) {
        q[i] = m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3];
    }
    return q;
}

struct ArrayMesh {
    std::string name;
    std::string format;
    std::uint64_t n_bytes = 0;  ///< of the input, for SourceInfo
    std::vector<TextureInfo> textures;
    std::vector<std::string> ignored;

    StridedArray positions;  ///< 3 components
    StridedArray normals;    ///< 3 components
    StridedArray colors;     ///< 3 or 4 components, 0..1
    StridedArray weights;    ///< 1 component
    StridedArray texcoords;  ///< 2 components; not delivered: for load_texcoords()
    StridedArray indices;    ///< 1 component; none: each vertex once, in order

    enum class Mode { Triangles, Strip, Fan };
    Mode mode = Mode::Triangles;
    /// Of positions; normals and winding follow.
    Affine transform = kIdentity;
    /// Colours are linear light (glTF), to be turned to sRGB, which scans have.
    bool has_linear_colors = false;
    /// Multiplies the colours, or is the colour of all if there are none.
    std::array<double, 4> color_factor{1, 1, 1, 1};
    /// Positions are delivered as doubles, not as the nearest floats.
    bool has_double_positions = false;
    /// Of temporary files behind the arrays that no other mesh has told.
    std::uint64_t held_temp_bytes = 0;

    [[nodiscard]] bool has_any_color() const {
        return colors.count > 0 || color_factor != std::array<double, 4>{1, 1, 1, 1};
    }
    /// Triangles, those that stitch a strip included.
    [[nodiscard]] std::uint64_t n_faces() const {
        const std::uint64_t n = indices.count > 0 ? indices.count : positions.count;
        if (mode == Mode::Triangles) return n / 3;
        return n < 2 ? 0 : n - 2;
    }
};

/// Reads where it lies; nothing is kept but the batches in flight. Indices outside the vertices are
/// dropped and counted. Throws: IoError, FormatError (a file that has shrunk; dirt in strict mode).
std::unique_ptr<MeshSource> open_arrays(ArrayMesh mesh, bool is_strict);

/// The texture coordinates first .. first + n - 1 of `mesh`. Any thread. Throws as open_arrays().
void load_texcoords(const ArrayMesh& mesh, std::uint64_t first, std::uint64_t n,
                    std::array<float, 2>* out);

}  // namespace hewer::streaming
