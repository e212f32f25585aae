// SPDX-License-Identifier: MIT
/// Minimal parsers of what the writers write, for tests only: they know nothing of the library's
/// own readers, so that an error shared by reader and writer cannot hide.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hewer::tests {

struct ParsedMesh {
    std::vector<std::string> header;  ///< PLY: its lines
    std::vector<std::array<double, 3>> positions;
    std::vector<std::array<double, 3>> normals;  ///< of vertices; STL: of facets
    std::vector<std::array<double, 4>> colors;   ///< in steps of the file
    std::vector<std::array<std::uint64_t, 3>> triangles;
    std::array<double, 3> translation{0, 0, 0};  ///< GLB: of the node
    std::array<double, 3> min{};                 ///< GLB: as the accessor says
    std::array<double, 3> max{};
    std::string alpha_mode;
    std::string generator;
    bool has_short_indices = false;
};

std::string read_whole(const std::filesystem::path& path);

/// Throw std::runtime_error if the file is not what it should be to the last byte.
ParsedMesh parse_ply(const std::filesystem::path& path);
ParsedMesh parse_obj(const std::filesystem::path& path);
ParsedMesh parse_stl(const std::filesystem::path& path);
ParsedMesh parse_glb(const std::filesystem::path& path);

}  // namespace hewer::tests
