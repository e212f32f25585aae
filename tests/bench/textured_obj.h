// SPDX-License-Identifier: MIT
/// A textured OBJ in memory, for the judge of textures: a reader of its own, bar the decoders of
/// images, so that a fault in how the product reads materials or samples shows.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace bench {

/// Red, green, blue, 0..1.
using Rgb = std::array<float, 3>;

struct Image {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgb;

    /// Bilinear, repeating; v upwards.
    [[nodiscard]] Rgb at(double u, double v) const;
};

struct TexturedObj {
    struct Corner {
        std::uint32_t vertex;
        std::uint32_t texcoord;
    };
    struct Face {
        std::array<Corner, 3> corners;
        std::size_t image;
    };
    std::vector<std::array<float, 3>> positions;
    std::vector<std::array<float, 2>> texcoords;
    std::vector<Face> faces;
    std::vector<Image> images;

    [[nodiscard]] Rgb color(const Face& face, double u, double v) const {
        return images[face.image].at(u, v);
    }
};

/// Triangles "f v/vt v/vt v/vt" with positive ids; "map_Kd FILE" without options. Throws
/// std::runtime_error, or what the decoders throw.
TexturedObj read_textured_obj(const std::string& path);

}  // namespace bench
