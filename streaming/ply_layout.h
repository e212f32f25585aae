// SPDX-License-Identifier: MIT
/// What hewer carries of a PLY file: which properties are positions, normals, colours, corners.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "hewer/mesh_source.h"
#include "streaming/ply_header.h"

namespace hewer::streaming {

/// A scalar property by its place among the scalars of its element: the sum of the sizes of the
/// scalars before it. In rows without lists that is its place in the row.
struct PlyField {
    ScalarType type = ScalarType::Float32;
    std::size_t offset = 0;
};

struct PlyVertexFields {
    std::array<PlyField, 3> position;
    std::optional<std::array<PlyField, 3>> normal;
    std::optional<std::array<PlyField, 3>> color;
    std::optional<PlyField> alpha;   ///< only with `color`
    std::optional<PlyField> weight;  ///< any scalar that was asked for
};

/// Texture coordinates, by the numbers of properties: at the corners of the faces, or at the
/// vertices.
struct PlyTexcoords {
    bool is_at_corners = false;
    std::size_t list = 0;                ///< of the face: u and v of each corner
    std::optional<std::size_t> texture;  ///< of the face: the number of its texture, else 0
    std::array<std::size_t, 2> uv{};     ///< of the vertex
};

struct PlyLayout {
    std::size_t vertex_element = 0;  ///< index in PlyHeader::elements
    PlyVertexFields vertex;
    std::size_t face_element = 0;
    std::size_t corner_property = 0;        ///< the list of vertex ids, in the face element
    bool is_strips = false;                 ///< the lists are triangle strips, -1 begins a new one
    std::optional<PlyTexcoords> texcoords;  ///< only where the header names textures
};

/// Finds these roles by name, whatever the order, and fills `info` (name, format, counts, what is
/// there, what is ignored). Names: x y z; nx ny nz; red green blue [alpha], also diffuse_red ... or
/// r g b [a]; vertex_indices or vertex_index in `face`, or in `tristrips` if there are no faces;
/// texcoord and texnumber in `face`; of vertices texture_u, u, s or tx, and texture_v, v, t or ty.
/// `weight_property` is the name of a scalar of the vertices, or empty.
/// Throws FormatError saying what is missing; point clouds and Gaussian splats are called by name;
/// InvalidArgument if there is no such scalar, with the names of those that there are.
PlyLayout plan_ply(const PlyHeader& header, const std::filesystem::path& path, SourceInfo& info,
                   const std::string& weight_property = {});

}  // namespace hewer::streaming
