// SPDX-License-Identifier: MIT
/// A mesh in another format, as it is: input for scripts/bench-formats.
///
///     convert_mesh IN OUT          streams; nothing is kept but batches
///     convert_mesh IN OUT.zst      the bytes of IN, compressed
///     convert_mesh --tiles IN DIR  eight tiles, DIR/0.ply to 7.ply, by the octant of the box that
///     a
///                                  triangle's first corner is in; vertices at borders in each tile
///                                  that uses them. Holds the mesh.
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "hewer/mesh_sink.h"
#include "hewer/mesh_source.h"

namespace {

using hewer::Mesh;
using hewer::Vec3;

void pour(const Mesh& mesh, const std::filesystem::path& path) {
    hewer::SinkHeader header;
    header.n_vertices = mesh.positions.size();
    header.n_triangles = mesh.triangles.size();
    for (const Vec3& p : mesh.positions) header.bounds.extend(p);
    const auto sink = hewer::create_mesh_file(path, {.overwrite = true});
    sink->begin(header);
    sink->add_vertices({mesh.positions, {}, {}});
    sink->add_triangles(mesh.triangles);
    sink->finish();
}

void convert(hewer::MeshSource& source, const std::filesystem::path& path) {
    const hewer::SourceInfo& info = source.info();
    const auto sink = hewer::create_mesh_file(path, {.overwrite = true});
    hewer::SinkHeader header;
    header.n_vertices = info.n_vertices;
    header.n_triangles = info.n_faces;
    header.has_normals = info.has_normals;
    header.has_colors = info.has_colors;
    header.has_alpha = info.has_alpha;
    header.has_double_positions = info.has_double_positions;
    hewer::VertexBatch vertices;
    source.begin_vertices();
    while (source.next_vertices(vertices)) {
        for (const Vec3& p : vertices.positions) header.bounds.extend(p);
    }
    sink->begin(header);
    const bool takes_points = sink->takes_points();
    std::vector<std::array<float, 3>> positions;  // for points
    source.begin_vertices();
    while (source.next_vertices(vertices)) {
        if (!takes_points) {
            sink->add_vertices({vertices.positions, vertices.normals, vertices.colors});
            continue;
        }
        for (const Vec3& p : vertices.positions) {
            positions.push_back(
                {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
        }
    }
    hewer::TriangleBatch triangles;
    std::vector<std::array<Vec3, 3>> points;
    source.begin_triangles();
    while (source.next_triangles(triangles)) {
        if (!takes_points) {
            sink->add_triangles(triangles.corners);
            continue;
        }
        points.clear();
        for (const hewer::Triangle& t : triangles.corners) {
            std::array<Vec3, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& p = positions[t[k]];
                corners[k] = {static_cast<double>(p[0]), static_cast<double>(p[1]),
                              static_cast<double>(p[2])};
            }
            points.push_back(corners);
        }
        sink->add_points(points);
    }
    sink->finish();
}

void compress(const std::filesystem::path& in, const std::filesystem::path& out) {
    constexpr std::size_t kPiece = 1 << 20;
    std::ifstream file(in, std::ios::binary);
    std::ofstream packed(out, std::ios::binary);
    ZSTD_CCtx* const context = ZSTD_createCCtx();
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 3);
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    std::vector<char> from(kPiece);
    std::vector<char> to(ZSTD_CStreamOutSize());
    for (bool is_end = false; !is_end;) {
        file.read(from.data(), static_cast<std::streamsize>(from.size()));
        const auto n = static_cast<std::size_t>(file.gcount());
        is_end = n < from.size();
        ZSTD_inBuffer input{from.data(), n, 0};
        std::size_t left = 1;
        while (input.pos < input.size || (is_end && left > 0)) {
            ZSTD_outBuffer output{to.data(), to.size(), 0};
            left = ZSTD_compressStream2(context, &output, &input,
                                        is_end ? ZSTD_e_end : ZSTD_e_continue);
            if (ZSTD_isError(left) != 0) throw std::runtime_error("zstd refuses");
            packed.write(to.data(), static_cast<std::streamsize>(output.pos));
        }
    }
    ZSTD_freeCCtx(context);
}

void cut(hewer::MeshSource& source, const std::filesystem::path& folder) {
    Mesh mesh;
    hewer::Bounds box;
    hewer::VertexBatch vertices;
    source.begin_vertices();
    while (source.next_vertices(vertices)) {
        for (const Vec3& p : vertices.positions) {
            mesh.positions.push_back(p);
            box.extend(p);
        }
    }
    const Vec3 middle = box.center();
    std::array<Mesh, 8> tiles;
    constexpr auto kNone = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::array<std::uint64_t, 8>> ids(mesh.positions.size());
    for (auto& of_tiles : ids) of_tiles.fill(kNone);
    hewer::TriangleBatch triangles;
    source.begin_triangles();
    while (source.next_triangles(triangles)) {
        for (const hewer::Triangle& t : triangles.corners) {
            std::size_t octant = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                octant |= mesh.positions[t[0]][k] > middle[k] ? std::size_t{1} << k : 0;
            }
            Mesh& tile = tiles[octant];
            hewer::Triangle own{};
            for (std::size_t k = 0; k < 3; ++k) {
                std::uint64_t& id = ids[t[k]][octant];
                if (id == kNone) {
                    id = tile.positions.size();
                    tile.positions.push_back(mesh.positions[t[k]]);
                }
                own[k] = id;
            }
            tile.triangles.push_back(own);
        }
    }
    std::filesystem::create_directories(folder);
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        if (tiles[i].triangles.empty()) continue;
        pour(tiles[i], folder / (std::to_string(i) + ".ply"));
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc == 4 && std::string(argv[1]) == "--tiles") {
            cut(*hewer::open_mesh(argv[2]), argv[3]);
        } else if (argc == 3 && std::filesystem::path(argv[2]).extension() == ".zst") {
            compress(argv[1], argv[2]);
        } else if (argc == 3) {
            convert(*hewer::open_mesh(argv[1]), argv[2]);
        } else {
            std::cerr << "usage: convert_mesh IN OUT | convert_mesh --tiles IN DIR\n";
            return 2;
        }
    } catch (const std::exception& e) {
        std::cerr << e.what() << '\n';
        return 1;
    }
    return 0;
}
