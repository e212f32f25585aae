// SPDX-License-Identifier: MIT
/// A plain PLY reader and writer for the benchmark's own programs, apart from the product's readers
/// so that a fault of those cannot hide in both a result and its check.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bench {

/// A triangle mesh as graphics libraries take it. 32-bit ids: peers have no others.
struct PlainMesh {
    std::vector<float> positions;        ///< x y z of each vertex
    std::vector<std::uint32_t> indices;  ///< three a triangle
};

/// Reads an ASCII or binary little-endian PLY: vertices first, with x, y, z of one type, float or
/// double (rounded to float), among scalar properties of any type; then faces with one list of
/// uchar count and int or uint ids. Polygons are fanned. Not general: other files throw
/// std::runtime_error. Memory: the mesh, and the bytes of one element at a time.
PlainMesh read_plain_ply(const std::string& path);

/// Binary little-endian. Throws std::runtime_error.
void write_plain_ply(const std::string& path, const PlainMesh& mesh);

/// For each vertex the first one at its position; -0 equals 0.
std::vector<std::uint32_t> first_at_position(const PlainMesh& mesh);

}  // namespace bench
