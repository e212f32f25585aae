// SPDX-License-Identifier: MIT
/// PLY and STL files of any layout as strings, written independently of the library.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hewer::test {

/// What goes into a file. Colours count in units of their type: 0..255, 0..65535 or 0..1.
struct PlyMesh {
    std::vector<std::array<double, 3>> positions;
    std::vector<std::array<double, 3>> normals;  ///< empty or as many as positions
    std::vector<std::array<double, 4>> colors;   ///< empty or as many as positions
    std::vector<std::vector<std::int64_t>> faces;
};

struct PlyStyle {
    std::string format = "binary_little_endian";
    std::string coordinate_type = "float";
    std::string normal_type = "float";
    std::string color_type = "uchar";
    std::array<std::string, 4> color_names{"red", "green", "blue", "alpha"};
    bool has_alpha = false;
    std::string count_type = "uchar";
    std::string index_type = "int";
    std::string index_name = "vertex_indices";
    bool has_strips = false;  ///< the lists are written as element tristrips
    bool faces_first = false;
    bool has_extra_scalars = false;
    bool has_extra_lists = false;     ///< of varying length
    bool has_extra_elements = false;  ///< before, between and after
    bool has_comments = false;
    std::string line_end = "\n";
    unsigned column_order = 0;  ///< permutes the vertex columns
    std::string token_end = " ";
    std::string row_end = "\n";  ///< ASCII only
};

std::string ply_file(const PlyMesh& mesh, const PlyStyle& style = {});

/// `value` as the bytes of a PLY type, or as text.
std::string ply_value(const std::string& format, const std::string& type, double value);

/// Binary STL; `announced` goes into the header's count.
std::string stl_file(const std::vector<std::array<std::array<double, 3>, 3>>& triangles,
                     std::uint32_t announced, const std::string& comment = "test");

}  // namespace hewer::test
