// SPDX-License-Identifier: MIT
#include "streaming/mesh_writer.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "hewer/error.h"
#include "streaming/file_sink.h"
#include "streaming/glb_writer.h"
#include "streaming/obj_writer.h"
#include "streaming/ply_writer.h"
#include "streaming/stl_writer.h"

namespace hewer {

namespace {

struct Format {
    std::string_view extension;
    std::unique_ptr<MeshSink> (*create)(const std::filesystem::path&, bool);
    std::uint64_t fixed_bytes;
    std::uint64_t bytes_per_vertex;
};

constexpr std::array<Format, 4> kFormats{{
    {".ply", streaming::create_ply, streaming::kFileSinkBytes, 0},
    {".obj", streaming::create_obj, streaming::kFileSinkBytes, 0},
    {".stl", streaming::create_stl, streaming::kFileSinkBytes, streaming::kStlVertexBytes},
    {".glb", streaming::create_glb, streaming::kFileSinkBytes + streaming::kGlbBytes, 0},
}};

const Format& format_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    // Not std::tolower: a path means the same in every locale.
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    const auto* const it = std::find_if(kFormats.begin(), kFormats.end(),
                                        [&](const Format& f) { return f.extension == extension; });
    if (it != kFormats.end()) return *it;
    std::string text = path.string() + ": ";
    text += extension.empty() ? "a name without extension" : "extension " + extension;
    text += " does not say how to write a mesh; supported are";
    for (const Format& f : kFormats)
        text += (&f == kFormats.data() ? " " : ", ") + std::string(f.extension);
    throw InvalidArgument(text);
}

}  // namespace

std::unique_ptr<MeshSink> create_mesh_file(const std::filesystem::path& path, bool overwrite) {
    return format_of(path).create(path, overwrite);
}

std::uint64_t streaming::sink_memory_bytes(const std::filesystem::path& path,
                                           const SinkHeader& header) {
    const Format& format = format_of(path);
    return format.fixed_bytes + format.bytes_per_vertex * header.n_vertices;
}

}  // namespace hewer
