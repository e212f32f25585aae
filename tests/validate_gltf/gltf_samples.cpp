// SPDX-License-Identifier: MIT
/// Writes one file for each thing that a glTF file of ours can hold: gltf_samples FOLDER. With
/// --draco in front, .drc files and Draco-compressed GLB files instead.
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>

#include "hewer/mesh_sink.h"
#include "tests/unit/streaming/sample_mesh.h"

namespace {

using hewer::Mesh;
using hewer::tests::wavy_sheet;

/// Plain, quantised, and compressed both ways; as one file and as two.
void write_gltf(const std::filesystem::path& folder, const std::string& name, const Mesh& mesh) {
    using hewer::Compression;
    for (const char* extension : {".glb", ".gltf"}) {
        for (const bool is_quantized : {false, true}) {
            for (const auto& [word, compression] :
                 {std::pair("", Compression::None), std::pair("_meshopt", Compression::Meshopt),
                  std::pair("_draco", Compression::Draco)}) {
                const std::filesystem::path path =
                    folder / (name + (is_quantized ? "_14bit" : "") + word + extension);
                hewer::MeshFileOptions options{.overwrite = true, .compression = compression};
                if (is_quantized) {
                    options.quantization = {hewer::Quantization::Kind::Bits, 14};
                }
                hewer::tests::pour(mesh, *hewer::create_mesh_file(path, options));
                std::cout << path.string() << '\n';
            }
        }
    }
}

/// At the precisions that are the fewest, the usual and the most bits.
void write_draco(const std::filesystem::path& folder, const std::string& name, const Mesh& mesh) {
    for (const char* extension : {".drc", ".glb"}) {
        for (const double bits : {8, 14, 30}) {
            if (extension == std::string(".glb") && bits > 16) continue;
            const std::filesystem::path path =
                folder / (name + "_" + std::to_string(static_cast<int>(bits)) + extension);
            hewer::MeshFileOptions options{.overwrite = true};
            options.quantization = {hewer::Quantization::Kind::Bits, bits};
            if (extension == std::string(".glb")) options.compression = hewer::Compression::Draco;
            hewer::tests::pour(mesh, *hewer::create_mesh_file(path, options));
            std::cout << path.string() << '\n';
        }
    }
}

template <typename Write>
void write_all(const std::filesystem::path& folder, const Write& write) {
    const Mesh both = wavy_sheet(60, 1, {0, 0, 0});
    Mesh normals = both;
    normals.colors.clear();
    Mesh colors = both;
    colors.normals.clear();
    Mesh plain = colors;
    plain.colors.clear();
    write(folder, "plain", plain);
    write(folder, "normals", normals);
    write(folder, "colors", colors);
    write(folder, "normals_colors", both);
    write(folder, "transparent", wavy_sheet(60, 1, {0, 0, 0}, 0x8000));
    write(folder, "map_coordinates", wavy_sheet(60, 1000, {5'000'123.25, 448'017.5, 312.125}));
    write(folder, "long_indices", wavy_sheet(300, 1, {-0.5, -0.5, 0}));
    Mesh odd = plain;  // 3 short indices a triangle: the chunk needs padding
    odd.triangles.resize(odd.triangles.size() - 1);
    write(folder, "odd_triangles", odd);
}

}  // namespace

int main(int argc, char** argv) {
    const bool is_draco = argc == 3 && std::string(argv[1]) == "--draco";
    if (argc != 2 && !is_draco) {
        std::cerr << "usage: gltf_samples [--draco] FOLDER\n";
        return 2;
    }
    try {
        if (is_draco) {
            write_all(argv[2], write_draco);
        } else {
            write_all(argv[1], write_gltf);
        }
    } catch (const std::exception& e) {
        std::cerr << e.what() << '\n';
        return 1;
    }
    return 0;
}
