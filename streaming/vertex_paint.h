// SPDX-License-Identifier: MIT
/// Colours of vertices from textures.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "hewer/types.h"
#include "ooc/context.h"
#include "streaming/corner_join.h"
#include "streaming/texture_filter.h"
#include "streaming/texture_set.h"

namespace hewer::streaming {

/// What a triangle shows: a texture, else a colour, else nothing.
struct Paint {
    std::optional<std::size_t> texture;  ///< number in the set
    /// Texture coordinates (u, v, 1) to places in the image, v downwards.
    std::array<std::array<double, 3>, 2> to_image{{{1, 0, 0}, {0, 1, 0}}};
    std::array<Wrap, 2> wrap{Wrap::Repeat, Wrap::Repeat};
    /// Also of triangles without usable texture coordinates.
    std::optional<MeanColor> color;
};

/// A triangle of a textured mesh. Ids beyond the vertices: not a triangle; beyond the texture
/// coordinates, or kNoPaint: without.
struct PaintedTriangle {
    static constexpr std::uint32_t kNoPaint = 0xffffffffU;
    Triangle corners;
    Triangle texcoords;
    std::uint32_t paint;
};

/// Where a textured mesh is. All functions are called by many threads at once.
struct PaintedMesh {
    std::uint64_t n_vertices = 0;
    LoadVertices<Vec3> load_positions;
    std::uint64_t n_texcoords = 0;
    LoadVertices<std::array<float, 2>> load_texcoords;
    std::uint64_t n_triangles = 0;
    /// The triangles from `first` on, as many as `out` has.
    std::function<void(std::uint64_t first, std::span<PaintedTriangle> out)> read_triangles;
    std::vector<Paint> paints;
};

/// Opaque, 16 bits.
Rgba16 to_rgba(const MeanColor& color);

/// Nothing: no painted triangle has the vertex.
using VertexColor = std::optional<MeanColor>;

/// take(colours) with the colours of all vertices, in their order, piece by piece: of each the mean
/// over the thirds of its triangles that are nearest to it (TextureFilter), by area. So each place
/// of the surface goes into the colour of one vertex, and the mean over the vertices of a cluster,
/// by their share of the surface, is that over all of its texels.
///
/// One pass over the triangles for as many vertices as there is memory for; sums are added in the
/// order of the triangles, so nothing depends on threads or memory. Triangles that use positions or
/// coordinates from all over a file that memory does not hold are slow. Memory: 32 bytes a vertex
/// of a pass, caches of vertices and tiles for each thread; all together three quarters of what is
/// free at most, and at least 2 MiB a thread. Throws: as the loaders do, OutOfMemoryBudget,
/// Cancelled.
void paint_vertices(ooc::Context& context, const PaintedMesh& mesh, const TextureSet& textures,
                    const std::function<void(std::span<const VertexColor>)>& take);

}  // namespace hewer::streaming
